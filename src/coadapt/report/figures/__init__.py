"""The report's figures, one a module, each a function from results to a matplotlib figure.

Figures are made with matplotlib's object interface and saved by `style.render`, so nothing depends
on a display or on global state, and the same results give the same bytes.
"""
