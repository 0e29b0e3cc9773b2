"""Lives of coatings, of one gear pair and of many, and of hubs; `gearidae.studies` has the public names."""
