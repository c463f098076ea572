"""Functions that read values from a picture in a test."""


def labelled(ax):
    """The artists of a picture by their names in the legend."""
    return dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))


def small_print(ax):
    """The words below a picture, in one line."""
    return " ".join(ax.figure.get_supxlabel().split())


def named_rows(ax):
    return [tick.get_text() for tick in ax.get_yticklabels()]


def in_legend(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]
