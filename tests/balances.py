"""What a sound run's energy balance must show."""


def assert_balanced(balance, scene):
    """The residual stays below the bound that the balance states for the scene's tolerance."""
    assert abs(balance.residual) <= balance.bound(scene.run.rtol, roller=scene.roller is not None)


def assert_closes(scene, solution):
    """Energy has gone through, and its balance closes; the balance."""
    assert solution.balance.throughput > 0.0
    assert_balanced(solution.balance, scene)
    return solution.balance
