"""What the tests of the figures share: the data of each figure, computed once, and its picture, which nobody changes."""

from functools import cache

from stribeck.figures import load_figure


@cache
def data_of(name):
    """Return the dataset of a figure."""
    return load_figure(name).data()


@cache
def picture_of(name):
    """Return the picture of a figure, laid out."""
    figure = load_figure(name).picture(data_of(name))
    figure.canvas.draw()
    return figure
