//! Playing a scene: clock, cameras, window, stills and video.
