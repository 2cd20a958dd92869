"""Commands of ``pslv`` that are more than a few lines; ``app.cli`` registers them."""
