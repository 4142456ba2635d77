"""The figures of [HF08] and [CK16] and what the papers claim, recomputed from FMU runs.

In: the packed FMUs. Out: `figures/*.png`, `figures/*.svg` and `report.md`. Every number in a caption or a table is that
of a run; of the papers only what their text says is quoted. One module for each group of figures.
"""
