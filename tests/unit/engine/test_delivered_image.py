"""What is said of an image that is not what was asked for."""

from __future__ import annotations

import numpy as np
import pytest

from equilux.worker import BadDelivery, checked_image


def test_an_image_with_rows_and_columns_exchanged_is_told_so() -> None:
    with pytest.raises(BadDelivery, match=r"shape \(4, 3, 3\), expected .* \(3, 4, 3\): rows and columns are exchanged"):
        checked_image(np.zeros((4, 3, 3)), (3, 4, 3))


def test_an_image_of_another_size_is_not_said_to_be_exchanged() -> None:
    with pytest.raises(BadDelivery, match=r"expected float32 or float64 of shape \(3, 4, 3\)$"):
        checked_image(np.zeros((5, 3, 3)), (3, 4, 3))
