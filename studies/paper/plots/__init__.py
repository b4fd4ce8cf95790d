"""Plots of the paper study, drawn from its results and written as PNG.

Every function returns why there is no picture, or an empty text. Cases that are missing are left out.
"""
