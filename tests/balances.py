"""What a sound run's energy balance must show."""


def assert_balanced(balance, scene):
    """The residual stays below the bound that the balance states for the scene's tolerance."""
    assert abs(balance.residual) <= balance.bound(scene.run.rtol, roller=scene.roller is not None)
