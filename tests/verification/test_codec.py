# SPDX-License-Identifier: MIT
"""Records of checkpoints and the store through JSON and back: every bit, and nothing else than records."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from stored import same

from sam.scene import LeftOut, Result, Status
from sam.scene.checkpoint import CodecError, decode, encode
from verification.runs import models

ARRAYS = arrays(
    st.sampled_from(["f8", "i4", "?", "U3", "u1"]),
    array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=3),
)
LEAVES = st.one_of(
    *(st.none(), st.booleans(), st.integers(), st.floats(), st.text(), st.binary(max_size=9), ARRAYS),
    *(st.floats().map(np.float64), st.integers(0, 9).map(np.int32)),
)
TAGS = st.sampled_from(["array", "bytes", "scalar", "tuple", "dict"])
TREES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.lists(inner, max_size=3).map(tuple),
        st.dictionaries(st.text(max_size=3) | TAGS, inner, max_size=3),
    ),
    max_leaves=12,
)


@settings(max_examples=150, deadline=None)
@given(TREES)
def test_any_values_come_back_through_json(value):
    tree, kept_arrays = encode(value)
    assert same(decode(json.loads(json.dumps(tree)), kept_arrays, object), value)


def test_an_array_that_is_met_twice_is_stored_once_and_is_one_again():
    array = np.arange(3.0)
    tree, kept_arrays = encode({"a": array, "b": [array]})
    found = decode(tree, kept_arrays, object)
    assert len(kept_arrays) == 1 and found["a"] is found["b"][0]


BAD = [object(), {1: 2}, np.array([None]), 1j, {"deep": [(set(),)]}, Path("x"), {"open": [Status.CONVERGED]}]


@pytest.mark.parametrize("value", [*BAD, {"open": LeftOut("a", "b")}])
def test_what_cannot_be_stored_is_refused(coarse_results, value):
    with pytest.raises(CodecError):
        encode(replace(coarse_results[models.SAM], discretisation={"x": value}))


BAD_TREES = [{"array": "none"}, {"dict": 3}, {"bytes": 3}, {"scalar": []}, {"tuple": 1}]


@pytest.mark.parametrize("tree", [*BAD_TREES, {"scalar": ["|O", "00" * 8]}, {"scalar": ["<f8", "0"]}])
def test_values_that_were_not_encoded_are_refused(tree):
    with pytest.raises(CodecError):
        decode(tree, {}, object)


@pytest.mark.parametrize(
    "change",
    [
        {"status": "fine"},
        {"model": None},
        {"quantities": {"force_N": "1"}},
        {"cost": {"ffts": {"tuple": []}}},
        {"left_out": [{"stage": "a"}]},
        {"left_out": [{"stage": "a", "reason": "b", "more": "c"}]},
        {"fields": {"points": [1.0], "cells": {}}},
        {"warnings": "none"},
        {"unknown": 1},
    ],
)
def test_a_record_with_a_field_of_another_type_is_refused(change):
    good, kept_arrays = encode(Result("sam", Status.CONVERGED, {"force_N": 1.0}, {}))
    assert decode(good, kept_arrays, Result).converged
    with pytest.raises(CodecError, match="not the values of a Result"):
        decode(good | change, kept_arrays, Result)
