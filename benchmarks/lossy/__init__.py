"""Random runs through doors that lose something: is a green verdict overturned by what was lost?"""
