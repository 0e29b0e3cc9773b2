from hypothesis import settings

# Compilation, once per machine, falls into whichever example comes first.
settings.register_profile("gearidae", deadline=None)
settings.load_profile("gearidae")
