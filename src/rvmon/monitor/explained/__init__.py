"""What records say beside the verdict, from plain data: whoever judged has noted it."""
