"""The figures of the article from our own solutions: a picture as PNG and SVG, and its data as NetCDF beside them.

One module for each figure, ``figure_3`` to ``figure_s1``; :func:`make_figures` makes and keeps them.
"""

from stribeck.figures.build import FIGURES, Made, PaperFigure, figure_names, load_figure, make_figures

__all__ = ["FIGURES", "Made", "PaperFigure", "figure_names", "load_figure", "make_figures"]
