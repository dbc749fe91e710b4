"""What a requirement means and why a verdict came out: words, pictures, example timelines."""
