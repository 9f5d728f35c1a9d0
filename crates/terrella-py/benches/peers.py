"""Frame times of this Earth beside those of VTK and pygfx: peers.py MAP [ROUNDS [FOLDER]].

Each renderer is a process of its own, all open at the same time; they draw by turns. A turn is `FRAMES` frames from a
satellite that looks straight down: from frame to frame the eye moves as in a film. A frame ends when its pixels are in memory as an array. `MAP` is
the map that VTK and pygfx put on a sphere. Prints the times as CSV: medians of all turns, and quartiles of VTK's time over the renderer's own in
the same round. `FOLDER` gets the first image of each renderer at each height.
"""

import json
import math
import statistics
import subprocess
import sys
import time

SIZE = (1280, 720)
VERTICAL_FOV_DEG = 45.0
HEIGHTS_KM = (600, 2_000, 7_000, 20_000)
EARTH_KM = 6378.137
FRAMES = 8
FRAME_S = 1 / 30
# Each turn begins elsewhere, so that land, sea, clouds and ice all come by.
TURN_DEG = 137.5
# Africa.
FIRST_DEG = 20.0
# Of the Sun from the eye, along the equator.
SUN_DEG = 30.0
# Cells of the others' spheres round the equator and from pole to pole: as many as blocks of 6 x 6 cells have.
CELLS = (96, 48)
# A circular orbit's angular speed, degrees a second, at one Earth radius.
SURFACE_DEG_S = math.degrees(math.sqrt(398600.4418 / EARTH_KM**3))


class Terrella:
    """This renderer, with `earth` and `sky` as in a scene."""

    DATE = "2018-03-20T12:00:00Z"

    def __init__(self, earth, sky):
        import terrella

        self._terrella = terrella
        self._scene = terrella.Scene.from_dict(
            {
                "time": {"start": self.DATE},
                "camera": {"mode": "geodetic", "lat_deg": 0, "lon_deg": 0, "height_km": 1_000, "fov_deg": VERTICAL_FOV_DEG},
                "earth": earth,
                "sky": sky,
                "output": {"size": list(SIZE), "samples": 1},
            }
        )
        self._noon = terrella.Epoch(self.DATE)
        self.version = f"{terrella.__version__}, {self._scene.adapter}"

    def draw(self, height_km, lon_deg):
        # The Sun crosses the meridian of Greenwich at noon, and moves west by 15 degrees an hour.
        time_ = self._noon - 240.0 * (lon_deg + SUN_DEG)
        camera = self._terrella.Camera.geodetic(0, lon_deg, height_km * 1e3, heading_deg=0, pitch_deg=-90, fov_deg=VERTICAL_FOV_DEG)
        return self._scene.color(time_, camera=camera, exposure_ev=0)


class Vtk:
    """A sphere with a map, lit by the Sun."""

    def __init__(self, map_file):
        import numpy as np
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy

        self._to_numpy = vtk_to_numpy
        self._numpy = np
        window = vtk.vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetMultiSamples(0)
        window.SetSize(*SIZE)
        renderer = vtk.vtkRenderer()
        window.AddRenderer(renderer)
        sphere = vtk.vtkTexturedSphereSource()
        sphere.SetThetaResolution(CELLS[0])
        sphere.SetPhiResolution(CELLS[1])
        sphere.SetRadius(EARTH_KM)
        reader = vtk.vtkJPEGReader()
        reader.SetFileName(map_file)
        texture = vtk.vtkTexture()
        texture.SetInputConnection(reader.GetOutputPort())
        texture.MipmapOn()
        texture.InterpolateOn()
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputConnection(sphere.GetOutputPort())
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        actor.SetTexture(texture)
        # The map's middle, Greenwich, belongs to the axis of x.
        actor.RotateZ(180)
        renderer.AddActor(actor)
        light = vtk.vtkLight()
        light.SetLightTypeToSceneLight()
        renderer.AddLight(light)
        renderer.GetActiveCamera().SetViewAngle(VERTICAL_FOV_DEG)
        self._window, self._renderer, self._light, self._pixels = window, renderer, light, vtk.vtkUnsignedCharArray()
        self.version = f"{vtk.vtkVersion().GetVTKVersion()}, {window.GetClassName()}"

    def draw(self, height_km, lon_deg):
        camera = self._renderer.GetActiveCamera()
        camera.SetPosition(*on_equator(EARTH_KM + height_km, lon_deg))
        camera.SetFocalPoint(0, 0, 0)
        camera.SetViewUp(0, 0, 1)
        self._light.SetPosition(*on_equator(1e6, lon_deg + SUN_DEG))
        self._renderer.ResetCameraClippingRange()
        self._window.Render()
        self._window.GetRGBACharPixelData(0, 0, SIZE[0] - 1, SIZE[1] - 1, 0, self._pixels)
        # Its rows begin at the bottom.
        return self._numpy.flipud(self._to_numpy(self._pixels).reshape(SIZE[1], SIZE[0], 4))


class Pygfx:
    """A sphere with a map, lit by the Sun."""

    def __init__(self, map_file):
        import numpy as np
        import PIL.Image
        import pygfx as gfx
        from rendercanvas.offscreen import OffscreenRenderCanvas

        canvas = OffscreenRenderCanvas(size=SIZE, pixel_ratio=1)
        self._renderer = gfx.WgpuRenderer(canvas, pixel_ratio=1, ppaa="none")
        # Its field of view is of the mean of width and height.
        aspect = SIZE[0] / SIZE[1]
        tangent = math.tan(math.radians(0.5 * VERTICAL_FOV_DEG)) * 0.5 * (1 + aspect)
        self._camera = gfx.PerspectiveCamera(math.degrees(2 * math.atan(tangent)), aspect)
        self._light = gfx.DirectionalLight()
        map_ = gfx.Texture(np.flipud(PIL.Image.open(map_file).convert("RGBA")).copy(), dim=2, generate_mipmaps=True, colorspace="srgb")
        material = gfx.MeshPhongMaterial(map=gfx.TextureMap(map_, filter="linear", mipmap_filter="linear"), specular="#000")
        globe = gfx.Mesh(gfx.sphere_geometry(EARTH_KM, *CELLS), material)
        globe.local.euler = (math.pi / 2, 0, 0)
        self._scene = gfx.Scene().add(globe, self._light)
        self._canvas, self._numpy = canvas, np
        canvas.request_draw(lambda: self._renderer.render(self._scene, self._camera))
        self.version = f"{gfx.__version__}, {self._renderer.device.adapter_info['device']}"

    def draw(self, height_km, lon_deg):
        distance_km = EARTH_KM + height_km
        self._camera.local.position = on_equator(distance_km, lon_deg)
        self._camera.depth_range = (0.5 * height_km, distance_km)
        self._camera.local.reference_up = (0, 0, 1)
        self._camera.look_at((0, 0, 0))
        self._light.local.position = on_equator(1e6, lon_deg + SUN_DEG)
        return self._numpy.asarray(self._canvas.draw())


def on_equator(distance_km, lon_deg):
    lon = math.radians(lon_deg)
    return distance_km * math.cos(lon), distance_km * math.sin(lon), 0.0


BARE = {
    "clouds": False,
    "normals": False,
    "night_lights": False,
    "water": False,
    "detail": False,
    "directional_reflectance": False,
    "atmosphere": "none",
}
RENDERERS = {
    "VTK": Vtk,
    "pygfx": Pygfx,
    "Terrella with one map": lambda _: Terrella(BARE, {"stars": False}),
    "Terrella as shipped": lambda _: Terrella({}, {}),
}


def serve(name, map_file):
    """Draws the turns that are named on standard input, and answers with milliseconds for each frame."""
    renderer = RENDERERS[name](map_file)
    print(json.dumps({"version": renderer.version}), flush=True)
    for line in sys.stdin:
        turn = json.loads(line)
        step_deg = FRAME_S * SURFACE_DEG_S * (1 + turn["height_km"] / EARTH_KM) ** -1.5
        begin = time.perf_counter()
        for frame in range(turn["frames"]):
            pixels = renderer.draw(turn["height_km"], (turn["lon_deg"] + frame * step_deg) % 360)
        ms = 1e3 * (time.perf_counter() - begin) / turn["frames"]
        if turn.get("save"):
            import PIL.Image

            PIL.Image.fromarray(pixels[..., :3].copy()).save(turn["save"])
        print(json.dumps({"ms": ms, "brightest": int(pixels[..., :3].max())}), flush=True)


class Worker:
    """A renderer in a process of its own."""

    def __init__(self, name, map_file):
        self.name = name
        self._process = subprocess.Popen(
            [sys.executable, __file__, "--serve", name, map_file], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.version = self._answer()["version"]

    def _answer(self):
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit(f"{self.name} ended with exit status {self._process.wait()}")
        return json.loads(line)

    def turn(self, height_km, lon_deg, frames=FRAMES, save=None):
        self._process.stdin.write(json.dumps({"height_km": height_km, "lon_deg": lon_deg, "frames": frames, "save": save}) + "\n")
        self._process.stdin.flush()
        answer = self._answer()
        # A picture without an Earth would be drawn quickly.
        if answer["brightest"] < 3:
            raise SystemExit(f"{self.name} draws no Earth from {height_km} km: its brightest pixel is {answer['brightest']} of 255")
        return answer["ms"]


def measure(map_file, rounds, save):
    workers = [Worker(name, map_file) for name in RENDERERS]
    for worker in workers:
        print(f"{worker.name}: {worker.version}", file=sys.stderr)
    print("--- begin csv\nheight_km,renderer,ms,ratio_to_vtk,first_quartile,third_quartile")
    for height_km in HEIGHTS_KM:
        times = {worker.name: [] for worker in workers}
        for worker in workers:
            picture = f"{save}/{height_km} {worker.name}.png" if save else None
            worker.turn(height_km, FIRST_DEG, frames=2, save=picture)
        for round_ in range(rounds):
            # The first of a round is not always the same.
            for worker in workers[round_ % len(workers) :] + workers[: round_ % len(workers)]:
                times[worker.name].append(worker.turn(height_km, FIRST_DEG + round_ * TURN_DEG))
        for name, of in times.items():
            ratios = [vtk / one for vtk, one in zip(times["VTK"], of)]
            first, median, third = statistics.quantiles(ratios, n=4, method="inclusive")
            print(f"{height_km},{name},{statistics.median(of):.1f},{median:.2f},{first:.2f},{third:.2f}", flush=True)
    print("--- end csv")


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["--serve", name, map_file]:
            serve(name, map_file)
        case [map_file, *rest]:
            measure(map_file, int(rest[0]) if rest else 16, rest[1] if len(rest) > 1 else None)
        case _:
            raise SystemExit(__doc__)
