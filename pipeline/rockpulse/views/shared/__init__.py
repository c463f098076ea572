"""Parts of several views: tables, marks and explanatory notes."""
