"""What flows: passive, frozen records, one module per step of the flow.

    light -> ImageFrame (image) -> color classes (colors) -> Blobs (blobs) -> Sightings (objects)
          -> World (tracks) -> RobotView (views) -> datagram

``field`` holds what does not flow: what stands on the field, and what an edge can be. Records hold no code
beyond trivial derived values. Stages are functions from records to records.
"""
