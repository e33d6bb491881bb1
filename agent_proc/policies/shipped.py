"""The policies that come with this package, as plug-ins."""

from agent_proc.policies.learned import LearnedPolicy, load_learned


def fixed() -> LearnedPolicy:
    """The policy that chooses leg and curve; all its pushes are 5 cm deep."""
    return load_learned("fixed")


def variable() -> LearnedPolicy:
    """The policy that chooses leg, curve and depth."""
    return load_learned("variable")


def wide() -> LearnedPolicy:
    """The policy that chooses leg, curve and depth, trained from wide starts."""
    return load_learned("wide")
