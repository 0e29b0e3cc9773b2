"""Records of a run: constants, what a checkpoint carries, work space, and the `Model` that holds them.

Every other package of the engine reads and writes these records; none of them is imported here.
"""
