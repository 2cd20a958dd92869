"""Pictures of figures, drawn with OpenCV: ``panels`` of histograms, ``layers`` of parts that add up over time."""
