"""Problems for PyTorch's autograd."""

import torch
from torch.autograd.function import once_differentiable


def _array(tensor):
    return tensor.detach().cpu().contiguous().numpy()


def _like(array, tensor):
    return torch.from_numpy(array).to(tensor.device)


class _Forward(torch.autograd.Function):
    @staticmethod
    def forward(ctx, x, given, problem):
        given = None if given is None else _array(given.to(x.dtype))
        y, ctx.tape = problem.linearize(_array(x), given)
        return _like(y, x)

    @staticmethod
    @once_differentiable
    def backward(ctx, y_bar):
        return _like(ctx.tape.pullback(_array(y_bar)), y_bar), None, None


def differentiable(problem):
    if "vjp" not in problem.names:
        raise TypeError(f"{problem.name} provides {'|'.join(problem.names)}, "
                        "no vjp, which autograd needs")

    def forward(x, given=None):
        if x.dtype not in (torch.float32, torch.float64):
            raise TypeError(f"x is {x.dtype}; float32 or float64 is right")
        return _Forward.apply(x, given, problem)

    return forward
