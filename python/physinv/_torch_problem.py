"""Functions of a forward pass in PyTorch."""

import numpy as np

try:
    import torch
except ImportError:
    raise ImportError('autodiff="torch" needs PyTorch (python3-torch)') from None


def _tensor(array):
    return torch.from_numpy(np.ascontiguousarray(array))


def _checked(y):
    if not isinstance(y, torch.Tensor):
        raise TypeError(f"forward returned {type(y).__name__}; expected a "
                        "tensor")
    return y


def _array(tensor):
    return tensor.detach().cpu().double().numpy()


def functions(forward):
    """forward, vjp and jacobian on NumPy's arrays."""

    def plain(x, given):
        with torch.no_grad():
            return _array(_checked(forward(_tensor(x), _tensor(given))))

    def recorded(x, given):
        x = _tensor(x).requires_grad_()
        with torch.enable_grad():
            return x, _checked(forward(x, _tensor(given)))

    def slope(y, x, y_bar):
        """A y that x does not enter has no slope."""
        if not y.requires_grad:
            return torch.zeros_like(x)
        x_bar, = torch.autograd.grad(y, x, y_bar, retain_graph=True,
                                     allow_unused=True)
        return torch.zeros_like(x) if x_bar is None else x_bar

    def vjp(x, given):
        at, y = recorded(x, given)
        return _array(y), lambda y_bar: _array(
            slope(y, at, _tensor(y_bar).to(y.dtype)))

    def jacobian(x, given):
        """Row by row, of all samples at once."""
        at, y = recorded(x, given)
        rows = [slope(y, at, unit.expand_as(y))
                for unit in torch.eye(y.shape[1], dtype=y.dtype)]
        return _array(torch.stack(rows, 1))

    return plain, vjp, jacobian
