"""What pictures are made of: figures, axes, colours, scales. The pictures are in `gearidae.plot` and of studies."""
