"""Batches of a data set for training, read by two workers: pytorch_loader.py FOLDER. Needs torch, and Pillow for WebDataset shards."""

import sys

from terrella import farm
from torch.utils.data import DataLoader

if __name__ == "__main__":
    data = farm.DataSet(sys.argv[1])
    for batch in DataLoader(data, batch_size=4, shuffle=True, num_workers=2, multiprocessing_context="spawn"):
        # Bytes to what convolutions take: sample × channel × row × column, 0 to 1.
        images = batch["color"].permute(0, 3, 1, 2).float() / 255
        print(tuple(images.shape), *(f"{name} {tuple(batch[name].shape)}" for name in data.layers))
