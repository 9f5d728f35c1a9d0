//! Rejected scenes, with place and remedy.

use super::{Bad, Folder};
use std::path::Path;
use terrella_play::scene::{Scene, SceneError};

#[rustfmt::skip]
const BAD: &[Bad] = &[
    // Unknown names.
    ("\n[camera]\nfov = 45", 3, &["[camera] fov:", "did you mean fov_deg?", "`terrella check --all` lists all keys"]),
    ("[camera]\nFOV_DEG = 45", 2, &["[camera] FOV_DEG:", "did you mean fov_deg?"]),
    ("[camera]\nspeed = 45", 2, &["[camera] speed:", "belongs in [time]"]),
    ("[output]\nqwxz = 1", 2, &["[output] qwxz: unknown key.", "[output] has size, samples"]),
    ("[time]\n\n[camra]\nmode = \"nadir\"", 3, &["[camra]:", "did you mean [camera]?"]),
    ("[weather]\nrain = true", 1, &["[weather]: unknown table", "[time], [orbit], [tracks], [station], [layers], [geojson], [coverage], [camera], [sensor], [earth], [sky], [lens], [caption], [output]"]),
    ("fov_deg = 45\n[time]", 1, &["fov_deg:", "outside its table", "[camera]"]),
    ("cloud = false", 1, &["cloud: unknown key", "did you mean clouds in [earth]?"]),
    // By what they mean, where no known name is alike.
    ("[orbit]\ntle = \"a.tle\"", 2, &["[orbit] tle:", "did you mean file?"]),
    ("[earth]\ndem = [\"a.tif\"]", 2, &["[earth] dem:", "did you mean elevation?"]),
    ("[time]\nfps = 24", 2, &["[time] fps:", "did you mean frame_rate_hz?"]),
    ("[time]\nepoch = \"now\"", 2, &["[time] epoch:", "did you mean start?"]),
    ("[output]\nfps = 24", 2, &["[output] fps:", "did you mean frame_rate_hz in [time]?"]),
    ("fps = 24", 1, &["fps: unknown key", "did you mean frame_rate_hz in [time]?"]),
    ("[satellite]\ntle = \"a.tle\"", 1, &["[satellite]:", "did you mean [orbit]?"]),
    ("[[stations]]\nname = \"A\"", 1, &["[stations]:", "did you mean [[station]]?"]),
    ("[stations]\nname = \"A\"", 1, &["[stations]:", "did you mean [station]?"]),
    ("[[station]]\ntitle = \"A\"", 2, &["[station] title:", "did you mean name?"]),
    ("[[caption]]\ntitle = \"A\"", 2, &["[caption] title:", "did you mean text?"]),
    ("title = \"A\"", 1, &["title: unknown key", "did you mean text in [caption]?"]),
    ("\"\\u001b[31m\" = 1", 1, &["\\u{1b}[31m: unknown key"]),
    ("[time.zone]\nname = \"CET\"", 1, &["[time] zone: unknown key"]),
    // Wrong types.
    ("[camera]\n# wide\nfov_deg = \"wide\"", 3, &["[camera] fov_deg = \"wide\"", "must be a number of degrees, not a string"]),
    ("[camera]\nfov_deg = true", 2, &["[camera] fov_deg = true", "must be a number of degrees"]),
    ("[camera]\nfov_deg = [45]", 2, &["[camera] fov_deg = [45]", "must be a number of degrees, not a list"]),
    ("[camera.fov_deg]\nx = 1", 1, &["[camera] fov_deg", "must be a number of degrees, not a table"]),
    ("[camera]\nmode = 1", 2, &["[camera] mode = 1", "must be a string", "\"nadir\", \"horizon\", \"chase\" or \"geodetic\""]),
    ("[earth]\nclouds = \"yes\"", 2, &["[earth] clouds = \"yes\"", "must be true or false, not a string"]),
    ("[earth]\ncloud_maps = 3", 2, &["[earth] cloud_maps = 3:", "a list of maps with their dates"]),
    ("[earth]\ncloud_maps = []", 2, &["[earth] cloud_maps", "a list of maps with their dates"]),
    ("[earth]\nday_maps = [\"a.jpg\", \"b.jpg\"]", 2, &["[earth] day_maps", "has 2 files without dates", "twelve"]),
    ("[earth]\ncloud_maps = [3]", 2, &["[earth] cloud_maps", "map 1: is 3"]),
    ("[earth]\ncloud_maps = [{ file = \"a.png\" }]", 2, &["map 1: needs date"]),
    ("[earth]\ncloud_maps = [{ date = \"noon\", file = \"a.png\" }]", 2, &["map 1: date:"]),
    ("[earth]\ncloud_maps = [{ date = 2018-01-15T12:00:00Z }]", 2, &["map 1: needs file"]),
    ("[earth]\ncloud_maps = [{ date = 2018-01-15T12:00:00Z, file = 3 }]", 2, &["map 1: file must be a string"]),
    ("[earth]\ncloud_maps = [{ date = 2018-01-15T12:00:00Z, file = \"no_such.png\" }]", 2, &["map 1:", "no_such.png", "cannot be opened"]),
    ("[earth]\ncloud_maps = [{ date = 2018-01-15T12:00:00Z, file = \".\" }]", 2, &["map 1:", "is no file"]),
    ("[earth]\ncloud_maps = [{ date = 2018-01-15T12:00:00Z, file = \"a.png\", layer = 1 }]", 2, &["map 1: a map has date and file, not layer"]),
    ("[earth]\nclouds = false\ncloud_maps = [{ date = 2018-01-15T12:00:00Z, file = \"a.png\" }]", 3, &["[earth] cloud_maps", "the scene leaves out"]),
    ("[earth]\nlook = \"paper\"\ncloud_maps = [{ date = 2018-01-15T12:00:00Z, file = \"a.png\" }]", 3, &["[earth] cloud_maps", "has no maps that change with the date", "look = \"standard\""]),
    ("[earth]\nmap_fade = false", 2, &["[earth] map_fade", "of which there are none"]),
    ("[earth]\nlook = \"paper\"\nseasons = true", 3, &["[earth] seasons", "the paper's shading has no seasons", "write false"]),
    ("[earth]\nwater = false\nseasons = true", 3, &["[earth] seasons", "without water there is no ice"]),
    ("[earth]\nsurface = \"quadtree\"\nelevation = []\nseasons = true", 4, &["[earth] seasons", "terrain has no ice on the sea"]),
    ("[earth]\nclouds = 1", 2, &["[earth] clouds = 1", "must be true or false"]),
    ("[earth]\nsubdivision = 6.5", 2, &["[earth] subdivision = 6.5", "must be \"auto\" or from 1 to 48"]),
    ("[earth]\nsubdivision = 99999999999999999999", 2, &["[earth] subdivision", "too large to be read"]),
    ("[time]\nspeed = 99999999999999999999", 2, &["[time] speed", "too large to be read"]),
    ("[time]\nspeed = 1e400", 2, &["[time] speed = 1e400", "too large to be read"]),
    ("[output]\nsize = \"1280x720\"", 2, &["[output] size = \"1280x720\"", "[width, height]"]),
    ("[output]\nsize = [1280,\n \"720\"]", 2, &["[output] size", "two whole numbers of pixels"]),
    ("[output]\nsize = [640.0, 360.0]", 2, &["[output] size", "two whole numbers of pixels"]),
    ("time = 5", 1, &["time = 5", "must be a table, not a whole number", "[time]"]),
    ("[[time]]\nspeed = 1", 1, &["time", "must be a table, not a list"]),
    ("[time]\nstart = 5", 2, &["[time] start = 5", "2018-01-15T12:00:00Z"]),
    ("[time.start]\nx = 1", 1, &["[time] start", "2018-01-15T12:00:00Z"]),
    ("[output]\nexposure_ev = \"bright\"", 2, &["[output] exposure_ev = \"bright\":", "from −20 to 20", "\"auto\""]),
    ("[output]\nexposure_ev = true", 2, &["[output] exposure_ev = true:", "must be a number of exposure values"]),
    ("[output]\ntone = \"aces\"", 2, &["[output] tone = \"aces\":", "\"neutral\", \"linear\", \"filmic\""]),
    ("[output]\ntone = 3", 2, &["[output] tone = 3:", "\"agx\"", "file = "]),
    ("[output]\ntone = { name = \"a\" }", 2, &["[output] tone =", "file = "]),
    ("[output]\ntone = { file = 1 }", 2, &["[output] tone =", "file must be a string"]),
    ("[output]\ntone = { file = \"nowhere.txt\" }", 2, &["[output] tone =", "nowhere.txt cannot be opened"]),
    ("[output]\ntone = { file = \"a.txt\", curve = \"b\" }", 2, &["[output] tone =", "a tone has file and name, not curve"]),
    ("[earth]\nlook = \"paper\"\n[output]\ntone = { file = \"a.txt\" }", 4, &["[output] tone =", "the paper's shading has no measured response"]),
    ("[earth]\nlook = \"fulll\"", 2, &["[earth] look = \"fulll\":", "did you mean \"full\"?"]),
    ("[earth]\nstrict = 1", 2, &["[earth] strict = 1", "must be true or false"]),
    // Not finite.
    ("[output]\nexposure_ev = nan", 2, &["[output] exposure_ev = nan:", "from −20 to 20"]),
    ("[output]\nexposure_ev = inf", 2, &["[output] exposure_ev = inf:", "from −20 to 20"]),
    ("[time]\nspeed = nan", 2, &["[time] speed = nan", "finite"]),
    ("[time]\nspeed = inf", 2, &["[time] speed = inf", "finite"]),
    ("[time]\nduration_s = nan", 2, &["[time] duration_s = nan", "finite"]),
    ("[time]\nframe_rate_hz = -inf", 2, &["[time] frame_rate_hz = -inf", "finite"]),
    ("[camera]\nfov_deg = nan", 2, &["[camera] fov_deg = nan", "finite"]),
    ("[camera]\nlat_deg = nan", 2, &["[camera] lat_deg = nan", "finite"]),
    ("[camera]\nlon_deg = inf", 2, &["[camera] lon_deg = inf", "finite"]),
    ("[camera]\nheight_km = nan", 2, &["[camera] height_km = nan", "finite"]),
    // Out of range.
    ("[earth]\naerosol_optical_depth = 5.1", 2, &["[earth] aerosol_optical_depth = 5.1:", "from 0 to 5"]),
    ("[earth]\naerosol_optical_depth = -0.1", 2, &["[earth] aerosol_optical_depth = -0.1:", "from 0 to 5"]),
    ("[earth]\naerosol_optical_depth = nan", 2, &["[earth] aerosol_optical_depth = nan", "finite"]),
    ("[output]\nbloom = 0.6", 2, &["[output] bloom = 0.6:", "from 0 to 0.5"]),
    ("[earth]\nlook = \"paper\"\n[output]\nbloom = 0.1", 4, &["[output] bloom = 0.1:", "the paper's shading has no bloom"]),
    ("[output]\nwhite_balance_k = 1999", 2, &["[output] white_balance_k = 1999:", "from 2000 to 12000 kelvins"]),
    ("[output]\nwhite_balance_k = nan", 2, &["[output] white_balance_k = nan:", "finite"]),
    ("[output]\ntint = 5", 2, &["[output] tint = 5:", "with white_balance_k alone"]),
    ("[output]\nwhite_balance_k = 5000\ntint = 151", 3, &["[output] tint = 151:", "from −150 to 150"]),
    ("[output]\ngrain = 0.08", 2, &["[output] grain = 0.08:", "from 0 to 0.07"]),
    ("[output]\ngrain_size_px = 2", 2, &["[output] grain_size_px = 2:", "no meaning without grain"]),
    ("[output]\ngrain = 0\ngrain_seed = 2", 3, &["[output] grain_seed = 2:", "no meaning without grain"]),
    ("[output]\ngrain = 0.05\ngrain_size_px = 0.5", 3, &["[output] grain_size_px = 0.5:", "from 1 to 16"]),
    ("[earth]\nlook = \"paper\"\n[output]\ngrain = 0.1", 4, &["[output] grain = 0.1:", "the paper's shading has no grain"]),
    ("[earth]\nwind_m_s = 31", 2, &["[earth] wind_m_s = 31:", "from 0 to 30 metres a second"]),
    ("[earth]\nrelief_exaggeration = -1", 2, &["[earth] relief_exaggeration = -1:", "from 0 to 20"]),
    ("[earth]\ncloud_height_km = 0", 2, &["[earth] cloud_height_km = 0:", "from 0.1 to 20 kilometres"]),
    ("[earth]\ncloud_relief_km = 21", 2, &["[earth] cloud_relief_km = 21:", "from 0 to 20 kilometres"]),
    ("[sky]\nstar_gain = -1", 2, &["[sky] star_gain = -1:", "from 0 to 1e6"]),
    ("[sky]\nfolder = \"nowhere\"", 2, &["[sky] folder", "nowhere"]),
    ("[sky]\nstars = 1", 2, &["[sky] stars = 1:", "true or false"]),
    ("[earth]\nnight_gain = 2e6", 2, &["[earth] night_gain = 2e6:", "from 0 to 1e6"]),
    ("[earth]\nlook = \"paper\"\nwind_m_s = 3", 3, &["[earth] wind_m_s = 3:", "the paper's shading has no wind_m_s", "look = \"standard\""]),
    ("[earth]\nshading = \"paper\"\ncloud_shadows = true", 3, &["[earth] cloud_shadows = true:", "the paper's shading"]),
    ("[sky]\neclipses = true\n[earth]\nshading = \"paper\"", 2, &["[sky] eclipses = true:", "the paper's shading has no eclipses"]),
    ("[output]\nexposure_ev = 20.1", 2, &["[output] exposure_ev = 20.1:", "from −20 to 20"]),
    ("[output]\nexposure_ev = -21", 2, &["[output] exposure_ev = -21:", "from −20 to 20"]),
    ("[camera]\nfov_deg = 0", 2, &["[camera] fov_deg = 0:", "must be more than 0 and less than 180 degrees", "0.001 to 179.999"]),
    ("[camera]\nfov_deg = 180", 2, &["[camera] fov_deg = 180:", "must be more than 0 and less than 180 degrees", "0.001 to 179.999"]),
    ("[camera]\nfov_deg = -45", 2, &["[camera] fov_deg = -45:", "must be more than 0"]),
    ("[camera]\nlat_deg = 91", 2, &["[camera] lat_deg = 91:", "must be from −90 to 90 degrees"]),
    ("[camera]\nlat_deg = -90.000001", 2, &["[camera] lat_deg = -90.000001:", "must be from −90 to 90 degrees"]),
    ("[camera]\nlon_deg = 361", 2, &["[camera] lon_deg = 361:", "must be from −360 to 360 degrees"]),
    ("[camera]\nheight_km = -5", 2, &["[camera] height_km = -5:", "inside the Earth", "0.001 to 1000000000 km"]),
    ("[camera]\nheight_km = 0", 2, &["[camera] height_km = 0:", "below the surface", "0.001 to 1000000000 km"]),
    ("[camera]\nheight_km = 2e9", 2, &["[camera] height_km = 2e9:", "0.001 to 1000000000 km"]),
    ("[camera]\npitch_deg = 91", 2, &["[camera] pitch_deg = 91:", "from −90 to 90 degrees", "straight down"]),
    ("[camera]\nheading_deg = 361", 2, &["[camera] heading_deg = 361:", "from −360 to 360 degrees", "clockwise from north"]),
    ("[camera]\nmode = \"chase\"\npitch_deg = 0", 3, &["[camera] pitch_deg = 0:", "no meaning with mode = \"chase\"", "mode = \"geodetic\""]),
    ("[camera]\nkeys = 3", 2, &["[camera] keys = 3", "a list of tables", "[[camera.keys]]"]),
    ("[camera.keys]\ntime_s = 0", 1, &["[camera] keys", "a list of tables"]),
    ("[camera]\nkeys = []", 2, &["[camera] keys = []", "must have 1 to 10000 keyframes"]),
    ("[[camera.keys]]\ntime_s = 0", 2, &["[camera.keys] time_s = 0:", "sets nothing", "fov_deg"]),
    ("[[camera.keys]]\nfov_deg = 40", 1, &["[camera.keys] time_s", "is missing", "a keyframe has time_s, and sets any of"]),
    ("[[camera.keys]]\ntime_s = 0\nfov = 40", 3, &["[camera.keys] fov = 40:", "did you mean fov_deg?"]),
    ("[[camera.keys]]\ntime_s = 0\nfov_deg = 180", 3, &["[camera.keys] fov_deg = 180:", "from 0.001 to 179.999 degrees"]),
    ("[[camera.keys]]\ntime_s = 0\nfov_deg = nan", 3, &["[camera.keys] fov_deg = nan:", "must be a number"]),
    ("[[camera.keys]]\ntime_s = \"noon\"\nfov_deg = 40", 2, &["[camera.keys] time_s = \"noon\":", "seconds after the scene's start"]),
    ("[[camera.keys]]\ntime_s = 0\nexposure_ev = 21", 3, &["[camera.keys] exposure_ev = 21:", "from −20 to 20"]),
    ("[[camera.keys]]\ntime_s = 5\nfov_deg = 40\n[[camera.keys]]\ntime_s = 5\nfov_deg = 30", 5, &["[camera.keys] time_s = 5:", "later than the keyframe before it, 5"]),
    ("[[camera.keys]]\ntime_s = 0\nlat_deg = 40", 3, &["[camera.keys] lat_deg = 40:", "needs lon_deg with it"]),
    ("[[camera.keys]]\ntime_s = 0\nheading_deg = 40", 3, &["[camera.keys] heading_deg = 40:", "needs pitch_deg with it"]),
    ("[[camera.keys]]\ntime_s = 0\nlat_deg = 0\nlon_deg = 0\nheight_km = 400\n[[camera.keys]]\ntime_s = 9\nlat_deg = 3\nlon_deg = 179\nheight_km = 400", 9, &["[camera.keys] lon_deg = 179:", "other side of the Earth", "a key between"]),
    ("[camera]\nmode = \"nadir\"\n[[camera.keys]]\ntime_s = 0\nlat_deg = 40", 5, &["[camera.keys] lat_deg = 40:", "no meaning with mode = \"nadir\"", "\"geodetic\""]),
    ("[camera]\nmode = \"chase\"\n[[camera.keys]]\ntime_s = 0\nyaw_deg = 4\npitch_deg = 0", 5, &["[camera.keys] yaw_deg = 4:", "\"nadir\" or \"horizon\""]),
    ("[[camera.keys]]\ntime_s = 0\noffset_m = [-40, 0, 0]", 3, &["[camera.keys] offset_m = [-40, 0, 0]:", "mode = \"chase\""]),
    ("[camera]\nmode = \"chase\"\n[[camera.keys]]\ntime_s = 0\noffset_m = [1, 0, 0]", 5, &["[camera.keys] offset_m = [1, 0, 0]:", "[ahead, right, down]", "15 m or more"]),
    ("[output]\nexposure_ev = \"auto\"\n[[camera.keys]]\ntime_s = 0\nexposure_ev = 1", 3, &["[camera] keys", "a keyframe sets exposure_ev, and [output] has exposure_ev = \"auto\"; leave one of them out"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\n[[camera.keys]]\ntime_s = 0\nfov_deg = 1", 4, &["[camera] keys", "a simulator gives the time"]),
    ("[earth]\nsubdivision = 0", 2, &["[earth] subdivision = 0:", "from 1 to 48"]),
    ("[earth]\nsubdivision = 49", 2, &["[earth] subdivision = 49:", "from 1 to 48"]),
    ("[earth]\nsubdivision = -6", 2, &["[earth] subdivision = -6:", "from 1 to 48"]),
    ("[output]\nsize = [0, 720]", 2, &["[output] size = [0, 720]:", "each be from 1 to 16384 pixels"]),
    ("[output]\nsize = [1280, 0]", 2, &["[output] size = [1280, 0]:", "each be from 1 to 16384 pixels"]),
    ("[output]\nsize = [100000, 720]", 2, &["[output] size = [100000, 720]:", "each be from 1 to 16384 pixels"]),
    ("[output]\nsize = [1280, 16385]", 2, &["[output] size = [1280, 16385]:", "each be from 1 to 16384 pixels"]),
    ("[output]\nsize = [-1280, 720]", 2, &["[output] size = [-1280, 720]:", "each be from 1 to 16384 pixels"]),
    ("[output]\nsize = [1280]", 2, &["[output] size = [1280]:", "two numbers, [width, height], not 1"]),
    ("[output]\nsize = [1280, 720, 3]", 2, &["[output] size = [1280, 720, 3]:", "two numbers, [width, height], not 3"]),
    ("[output]\nsamples = 2", 2, &["[output] samples = 2:", "must be 1", "or 4"]),
    ("[time]\nspeed = 0", 2, &["[time] speed = 0:", "never end"]),
    ("[time]\nspeed = -0.0", 2, &["[time] speed = -0.0:", "never end"]),
    ("[time]\nspeed = 1000001", 2, &["[time] speed = 1000001:", "−1000000 to 1000000"]),
    ("[time]\nduration_s = 0", 2, &["[time] duration_s = 0:", "more than 0"]),
    ("[time]\nduration_s = -60", 2, &["[time] duration_s = -60:", "more than 0"]),
    ("[time]\nduration_s = 2e9", 2, &["[time] duration_s = 2e9:", "at most 1000000000 seconds"]),
    ("[time]\nframe_rate_hz = 0.5", 2, &["[time] frame_rate_hz = 0.5:", "1 to 240 frames per second"]),
    ("[time]\nframe_rate_hz = 241", 2, &["[time] frame_rate_hz = 241:", "1 to 240 frames per second"]),
    ("[time]\nduration_s = 1e8", 2, &["[time] duration_s = 1e8:", "more than 10000000 frames", "shorten the duration"]),
    ("[time]\nspeed = -1e-9", 2, &["[time] speed = -1e-9:", "more than 10000000 frames", "raise the speed"]),
    // Dates.
    ("[time]\nstart = \"yesterday\"", 2, &["[time] start = \"yesterday\":", "2018-01-15T12:00:00Z"]),
    ("[time]\nstart = \"2018-02-30T12:00:00Z\"", 2, &["[time] start = \"2018-02-30T12:00:00Z\":", "is not a UTC date"]),
    ("[time]\nstart = 12:30:00", 2, &["[time] start = 12:30:00:", "must have a date", "2018-01-15T12:00:00Z"]),
    ("[time]\nstart = \"15.01.2018 12:30\"", 2, &["[time] start = \"15.01.2018 12:30\":", "is not a UTC date"]),
    ("[time]\nstart = \"1066-10-14T09:00:00Z\"", 2, &["[time] start = \"1066-10-14T09:00:00Z\":", "1900 to 2099"]),
    ("[time]\nstart = \"2099-06-01T00:00:00Z\"\nduration_s = 1e9\nspeed = 1e6", 3, &["[time] duration_s = 1e9:", "1900 to 2099"]),
    ("[time]\nstart = 2099-12-31T23:00:00Z", 2, &["[time] start = 2099-12-31T23:00:00Z:", "reach the year 2100"]),
    // Names.
    ("[camera]\nmode = \"nadr\"", 2, &["[camera] mode = \"nadr\":", "\"nadir\", \"horizon\", \"chase\", \"geodetic\"", "did you mean \"nadir\"?"]),
    ("[earth]\nfigure = \"flat\"", 2, &["[earth] figure = \"flat\":", "\"wgs84\", \"sphere\""]),
    ("[earth]\nvisibility = \"\"", 2, &["[earth] visibility = \"\":", "\"conservative\", \"paper\""]),
    ("[earth]\nshading = \"Paper\"", 2, &["[earth] shading = \"Paper\":", "did you mean \"paper\"?"]),
    ("[earth]\natmosphere = \"off\"", 2, &["[earth] atmosphere = \"off\":", "\"billboard\", \"none\""]),
    ("[orbit]\nsource = \"gps\"", 2, &["[orbit] source = \"gps\":", "\"tle\"", "\"numerical\""]),
    // Conflicts.
    ("[camera]\nmode = \"horizon\"\nup = \"north\"", 3, &["[camera] up = \"north\":", "no meaning with mode = \"horizon\""]),
    ("[camera]\nup = \"left\"", 2, &["[camera] up", "left", "flight", "north"]),
    ("[camera]\nmode = \"nadir\"\nlat_deg = 10", 3, &["[camera] lat_deg = 10:", "no meaning with mode = \"nadir\"", "mode = \"geodetic\""]),
    ("[camera]\nheight_km = 400\nmode = \"chase\"", 2, &["[camera] height_km = 400:", "no meaning with mode = \"chase\""]),
    ("[earth]\nshading = \"paper\"\nnight_lights = true", 3, &["[earth] night_lights = true:", "no night lights", "look = \"standard\""]),
    ("[orbit]\nname = \"ISS (ZARYA)\"", 2, &["[orbit] name = \"ISS (ZARYA)\":", "add file"]),
    ("[orbit]\nfile = \"sat.tle\"\nname = \" \"", 3, &["[orbit] name = \" \":", "must not be empty"]),
    // Files and folders.
    ("[orbit]\nfile = \"nowhere.tle\"", 2, &["[orbit] file = \"nowhere.tle\":", "cannot be opened", "relative to the scene's folder"]),
    ("[orbit]\nfile = \"maps\"", 2, &["[orbit] file = \"maps\":", "is a folder", "a file"]),
    ("[orbit]\nfile = \"\"", 2, &["[orbit] file = \"\":", "must not be empty"]),
    ("[orbit]\nfile = \"a\\u0000b\"", 2, &["[orbit] file", "cannot be opened"]),
    ("[earth]\ntextures = \"nowhere\"", 2, &["[earth] textures = \"nowhere\":", "cannot be opened", "relative to the scene's folder"]),
    ("[earth]\ntextures = \"sat.tle\"", 2, &["[earth] textures = \"sat.tle\":", "is a file", "a folder"]),
    // Packs.
    ("[earth]\npack = \"nowhere\"", 2, &["[earth] pack = \"nowhere\":", "cannot be opened"]),
    ("[earth]\npack = \"maps\"\ntextures = \"maps\"", 3, &["[earth] textures", "leave out textures or pack"]),
    ("[earth]\nlevels = \"screen\"", 2, &["[earth] levels", "for imagery packs", "pack = \"…\""]),
    ("[earth]\ntexture_mb = 64", 2, &["[earth] texture_mb = 64", "for imagery packs"]),
    ("[earth]\npack = \"maps\"\nlevels = \"fine\"", 3, &["[earth] levels = \"fine\":", "\"screen\", \"paper\""]),
    ("[earth]\npack = \"maps\"\nlevels = \"paper\"\ntexel_px = 2", 4, &["[earth] texel_px = 2", "distances alone decide"]),
    ("[earth]\npack = \"maps\"\ntexel_px = 0", 3, &["[earth] texel_px = 0:", "must be from 0.25 to 16"]),
    ("[earth]\npack = \"maps\"\ntexture_mb = 0.5", 3, &["[earth] texture_mb = 0.5:", "must be from 1 to 1000000 megabytes"]),
    ("[earth]\npack = \"maps\"\nupload_mb = -1", 3, &["[earth] upload_mb = -1:", "must be from 0.01 to 10000"]),
    ("[earth]\npack_heights = true", 2, &["[earth] pack_heights = true", "for imagery packs"]),
    ("[earth]\nground_mb = 64", 2, &["[earth] ground_mb = 64", "for imagery packs"]),
    ("[earth]\npack = \"maps\"\nground_mb = 64", 3, &["[earth] ground_mb = 64", "pack_heights = true"]),
    ("[earth]\npack = \"maps\"\npack_heights = true\nground_mb = 0.5", 4, &["[earth] ground_mb = 0.5:", "must be from 1 to 1000000 megabytes"]),
    ("[earth]\npack = \"maps\"\nstorage = \"dds\"", 3, &["[earth] storage = \"dds\":", "\"auto\", \"plain\", \"bc\""]),
    ("[earth]\npack = \"maps\"\nshading = \"paper\"\nwater = true", 4, &["[earth] water = true:", "no water"]),
    ("[output]\nwait_s = 5", 2, &["[output] wait_s = 5", "for imagery packs"]),
    ("[earth]\npack = \"maps\"\n[output]\nwait_s = 5000", 4, &["[output] wait_s = 5000:", "must be from 0 to 3600"]),
    ("[quality]\ntarget_ms = 0", 2, &["[quality] target_ms = 0:", "must be from 1 to 1000 milliseconds"]),
    ("[orbit]\nburns = []", 2, &["[orbit] burns", "is for source = \"numerical\""]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nmethod = \"euler\"", 4, &["[orbit] method = \"euler\":", "\"implicit\""]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nevents = [\"noon\"]", 4, &["[orbit] events", "\"noon\"", "\"apsides\""]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nevents = [\"nodes\", \"nodes\"]", 4, &["[orbit] events", "twice"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nburns = 3", 4, &["[orbit] burns = 3:", "a list of burns"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nburns = [3]", 4, &["[orbit] burns", "burn 1", "a table"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nburns = [{ duration_s = 3 }]", 4, &["[orbit] burns", "burn 1: needs start"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nburns = [{ start = \"noon\", duration_s = 3, acceleration_m_s2 = [1, 0, 0] }]", 4, &["burn 1: start"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nburns = [{ start = \"2018-01-15T12:00:00Z\", duration_s = 0, acceleration_m_s2 = [1, 0, 0] }]", 4, &["burn 1: duration_s must be"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nburns = [{ start = \"2018-01-15T12:00:00Z\", duration_s = 1, acceleration_m_s2 = [1, nan, 0] }]", 4, &["burn 1: acceleration_m_s2 must be three numbers"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nburns = [{ start = \"2018-01-15T12:00:00Z\", duration_s = 1, acceleration_m_s2 = [1, 0, 0], axes = \"lvlh\" }]", 4, &["burn 1: axes is", "\"flight\""]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nburns = [{ start = \"2018-01-15T12:00:00Z\", thrust_n = 1 }]", 4, &["burn 1: a burn has", "not thrust_n"]),
    ("[quality]\nscale = 0.2", 2, &["[quality] scale = 0.2:", "must be from 0.25 to 1"]),
    ("[quality]\nscale = nan", 2, &["[quality] scale = nan:", "finite"]),
    ("[quality]\nladder = \"sat.tle\"", 2, &["[quality] ladder = \"sat.tle\":", "set target_ms too"]),
    ("[quality]\ntarget_ms = 16\nladder = \"maps\"", 3, &["[quality] ladder = \"maps\":", "is a folder"]),
    ("[quality]\ntarget = 16", 2, &["[quality] target", "target_ms"]),
    // Not TOML.
    ("[time]\nspeed 60", 2, &["is not TOML", "`"]),
    ("[time]\nspeed = 60\nspeed = 70", 3, &["is not TOML", "duplicate", "`speed`; leave one of the two out"]),
    ("[time]\n[camera]\n[time]", 3, &["is not TOML", "duplicate", "write [time] once"]),
    ("[orbit]\n[camera]\n[orbit]", 3, &["duplicate key", "write [[orbit]] for each of several satellites"]),
    ("[orbit]\n[camera]\n  [[ orbit ]] # two", 3, &["duplicate key", "write [[orbit]] for each of several satellites"]),
    ("[station]\n[station]", 2, &["duplicate key", "write [[station]] for each of several ground stations"]),
    ("[geojson]\n[geojson]", 2, &["duplicate key", "write [[geojson]] for each of several files"]),
    ("[caption]\n[caption]", 2, &["duplicate key", "write [[caption]] for each of several captions"]),
    ("[camera.keys]\n[camera.keys]", 2, &["duplicate key", "write [[camera.keys]] for each of several keyframes"]),
    ("[earth]\nclouds = yes", 2, &["is not TOML", "`yes`; write true or false"]),
    ("[earth]\nclouds = no # none", 2, &["is not TOML", "`no`; write true or false"]),
    ("[earth]\nclouds = on", 2, &["is not TOML", "`on`; write true or false"]),
    ("[earth]\nclouds = off", 2, &["is not TOML", "`off`; write true or false"]),
    ("[earth]\nclouds = True", 2, &["is not TOML", "`True`; write true or false"]),
    ("[time\nspeed = 60", 1, &["is not TOML"]),
    ("[camera]\nmode = \"nadir", 2, &["is not TOML"]),
    ("[camera]\nmode =", 2, &["is not TOML"]),
];

#[test]
fn every_bad_scene_is_rejected_with_file_line_key_and_remedy() {
    Folder::new().rejects(BAD);
}

/// A list of up to ninety names would hide the suggestion.
#[test]
fn a_suggestion_stands_without_the_list_of_names() {
    for (text, near, other) in [
        (
            "[earth]\nloook = \"full\"",
            "did you mean look?",
            "night_gain",
        ),
        ("[stations]\n", "did you mean [station]?", "[sky]"),
        ("fps = 24", "did you mean frame_rate_hz in [time]?", "[sky]"),
        ("[camera]\nspeed = 45", "it belongs in [time]", "fov_deg"),
        (
            "[orbit]\nnode_deg = 3",
            "now called raan_deg",
            "true_anomaly_deg",
        ),
        (
            "[[camera.keys]]\ntime_s = 0\nfov = 40",
            "did you mean fov_deg?",
            "exposure_ev",
        ),
    ] {
        let error = Folder::new().load(text).expect_err("an unknown name");
        let message = error.to_string();
        assert!(message.contains(near), "{message}");
        assert!(!message.contains(other), "{message}");
    }
}

#[test]
fn a_file_that_cannot_be_a_scene_is_named_and_rejected() {
    let folder = Folder::new();

    let path = folder.path("nowhere.toml");
    let error = Scene::load(&path).expect_err("no such file");
    assert!(matches!(error, SceneError::Read { .. }));
    let message = error.to_string();
    assert!(
        message.starts_with(&path.display().to_string()),
        "{message}"
    );
    assert!(message.contains("config/iss.toml"), "{message}");

    let error = Scene::load(&folder.path("maps")).expect_err("a folder");
    assert!(matches!(error, SceneError::Folder { .. }), "{error}");

    let error = folder
        .load(b"[camera]\nmode = \"\xff\"")
        .expect_err("not UTF-8");
    assert!(
        matches!(error, SceneError::NotUtf8 { line: 2, .. }),
        "{error}"
    );

    let mut text = "#".repeat(Scene::MAX_FILE_BYTES as usize);
    assert!(folder.load(&text).is_ok(), "the limit itself is allowed");
    text.push('#');
    let error = folder.load(&text).expect_err("one byte too many");
    assert!(matches!(error, SceneError::TooLarge { .. }), "{error}");
    assert!(error.to_string().contains("1048576 bytes"), "{error}");
}

/// A device has no length to be rejected by.
#[cfg(unix)]
#[test]
fn an_endless_file_is_rejected() {
    let error = Scene::load(Path::new("/dev/zero")).expect_err("endless");
    let words = "it is a device, not a file";
    assert!(error.to_string().contains(words), "{error}");
}
