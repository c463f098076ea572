"""The parametric study of Casapulla & Maione (2017), section 4, as datasets."""
