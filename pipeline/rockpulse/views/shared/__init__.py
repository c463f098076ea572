"""Parts that several views use: tables, marks and explanatory notes."""
