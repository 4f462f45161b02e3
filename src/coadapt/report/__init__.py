"""The report: the paper's task solved, its figures and tables made, its claims checked.

`coadapt.report.reproduce` computes, and knows no drawing; `tables`, `figures` and `html` write what
it found. Drawing libraries are imported by those who draw.
"""
