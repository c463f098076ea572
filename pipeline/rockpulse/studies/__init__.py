"""Questions asked of many records: a site, the accuracy of models, the rule, fragility, and the study of the paper."""
