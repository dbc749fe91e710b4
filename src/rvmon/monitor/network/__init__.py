"""The one-shot evaluation of networks of windows, for reasons, forecasts and pictures."""
