"""Eleven mistakes, each on a line of its own that type checkers must name."""

import terrella
from terrella import farm

begin = terrella.Epoch("2018-06-21T12:00:00Z")
camera = terrella.Camera.geodetic(13, 14, 5e6)
earth = terrella.Earth((64, 36))
scene = terrella.Scene("iss.toml")
catalogue = terrella.Catalogue("iss.tle")
terrella.Epoch(1.5e9)  # mistake: a bare number is no instant
terrella.Earth((64, 36), sample=4)  # mistake: no such option
terrella.Earth(64, 36)  # mistake: the size is a pair
earth.color("above Lake Chad", begin)  # mistake: no camera
earth.frame(camera, begin, wait=3.0)  # mistake: it is called wait_s
scene.frame(camera, begin)  # mistake: the camera comes by its name
scene.frames(first="one")  # mistake: a text for a number
catalogue.propagate([begin], "j2000")  # mistake: no such frame
catalogue.passes(48.2, 16.4, first=begin)  # mistake: no end
begin < "2018-06-21T12:00:00Z"  # mistake: a text is not compared
farm.sweep("look.toml", "data", 8, format="tfrecord")  # mistake: no such format
