"""The figures and claims of [HF08] and [CK16], recomputed from FMU runs.

In: the packed FMUs. Out: `figures/*.png`, `figures/*.svg` and `report.md`. Every number in a caption or a table is from
a run, except those quoted from the papers' text. One module for each group of figures.
"""
