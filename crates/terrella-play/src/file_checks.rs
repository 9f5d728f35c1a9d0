//! Files of a scene that are read only when its pictures are drawn, looked at before.

use super::error::PlayError;
use super::flight::Flight;
use super::quality_control::ladder_of;
use super::relief::check_ground;

impl Flight {
    /// Checks the quality ladder, the measured response of the tone, the kernel of a sensor, and the headers and sidecars of elevation files.
    pub fn check_files(&self) -> Result<(), PlayError> {
        ladder_of(self.scene())?;
        self.scene().output.tone.open()?;
        if let Some(sensor) = &self.scene().sensor {
            sensor.open()?;
        }
        match &self.scene().earth.relief {
            Some(table) => check_ground(table),
            None => Ok(()),
        }
    }
}
