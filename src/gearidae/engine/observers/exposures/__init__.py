"""What the flanks are exposed to, tooth by tooth and bin by bin."""
