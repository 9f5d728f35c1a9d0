//! Pages of contours.
