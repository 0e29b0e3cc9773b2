"""Laws of a shaft, one file each; `gearidae.laws.shafts` lists them."""
