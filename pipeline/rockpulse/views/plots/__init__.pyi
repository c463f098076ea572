from .drawing import draw as draw
from .drawing import plot as plot
from .model_histories import ModelHistory as ModelHistory
from .model_histories import histories as histories
from .picture_kinds import KINDS as KINDS
from .spectra import selected_spectra as selected_spectra
from .style import picture_bytes as picture_bytes
from .style import svg as svg
