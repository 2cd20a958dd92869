"""Base class of everything that the API reports."""

from pydantic import BaseModel, ConfigDict


class Report(BaseModel):
    """A frozen model whose docstrings describe its fields."""

    model_config = ConfigDict(frozen=True, use_attribute_docstrings=True)
