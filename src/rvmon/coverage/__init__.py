"""What runs were seen to do, against what they should show: models, hits, databases of them."""
