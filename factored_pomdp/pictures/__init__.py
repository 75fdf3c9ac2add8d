"""Pictures of models and of what was solved; matplotlib is loaded only by the functions that draw."""
