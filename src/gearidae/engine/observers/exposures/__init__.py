"""What the flanks are exposed to, tooth by tooth and place by place."""
