"""NumPy, h5py, Matplotlib and the imaging library that it needs, which are installed if they are missing."""

import importlib.util

from shared import install

if not all(map(importlib.util.find_spec, ("numpy", "h5py", "matplotlib"))):
    install("python3-matplotlib", "python3-h5py")

import h5py
import matplotlib
import numpy as np
from PIL import Image

matplotlib.use("Agg")
from matplotlib import pyplot as plt

__all__ = ["Image", "h5py", "matplotlib", "np", "plt"]
