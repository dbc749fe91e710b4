"""What names stand for: each is declared once, no definition goes round, all are used."""
