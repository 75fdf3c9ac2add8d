"""Factors: functions over a scope of variables, in several representations behind one algebra."""

from factored_pomdp.factors.base import Factor
from factored_pomdp.factors.dense import DenseFactor, constant
from factored_pomdp.factors.deterministic import DeterministicFactor
from factored_pomdp.factors.expected_noisy_or import ExpectedNoisyOr
from factored_pomdp.factors.noisy_or import Cause, NoisyOr
from factored_pomdp.factors.sparse import SparseFactor

__all__ = [
    "Cause",
    "DenseFactor",
    "DeterministicFactor",
    "ExpectedNoisyOr",
    "Factor",
    "NoisyOr",
    "SparseFactor",
    "constant",
]
