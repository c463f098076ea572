from .parametric_analysis import figure4 as figure4
from .time_histories import figure5 as figure5
