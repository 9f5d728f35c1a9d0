import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
# One adapter for all machines' tests.
os.environ.setdefault("TERRELLA_TEXTURES", str(ROOT / "textures"))


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def earth():
    import terrella

    return terrella.Earth((256, 144))


@pytest.fixture(scope="session")
def scene(root):
    import terrella

    return terrella.Scene(root / "config/iss.toml", size=(256, 144))
