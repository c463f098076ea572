"""The parametric study of Casapulla & Maione (2017), section 4, with a verdict on each statement."""
