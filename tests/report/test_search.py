"""The search for the largest file within a budget."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from vmesh.report.search import largest_within

SIZES = st.lists(st.integers(1, 10**6), min_size=1, max_size=60).map(sorted)


@given(SIZES, st.integers(0, 10**6 + 1), st.data())
def test_the_largest_file_within_a_budget_is_found(
    sizes: list[int], budget: int, data: st.DataObject
) -> None:
    levels = range(3, 3 + len(sizes))
    by_level = dict(zip(levels, sizes, strict=True))
    known = data.draw(st.sets(st.sampled_from(levels)))
    asked: list[int] = []

    def size_of(level: int) -> int:
        asked.append(level)
        return by_level[level]

    found = largest_within(budget, levels, size_of, {level: by_level[level] for level in known})
    fits = [level for level in levels if by_level[level] <= budget]
    assert found == max(fits, default=None)
    assert len(asked) == len(set(asked))
    assert known.isdisjoint(asked)


def test_files_that_grow_evenly_are_found_in_a_few_steps() -> None:
    asked: list[int] = []

    def size_of(level: int) -> int:
        asked.append(level)
        return round(1000 * 1.05**level)

    assert largest_within(7777, range(101), size_of, {0: 1000, 100: 131_501}) == 42
    assert len(asked) <= 3
