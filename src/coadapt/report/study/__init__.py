"""The report of a study's analysis: page, figures, tables for a paper."""
