"""Laws of a tooth pair that need tables of asperities, one file each; `gearidae.engine.laws.pairs` lists all."""
