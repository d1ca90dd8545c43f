"""Problems for PyTorch's autograd."""

import torch

_PRECISIONS = (torch.float32, torch.float64)


def _array(tensor):
    return tensor.detach().cpu().contiguous().numpy()


def _like(array, tensor):
    return torch.from_numpy(array).to(tensor.device)


class _Forward(torch.autograd.Function):
    @staticmethod
    def forward(ctx, x, given, problem):
        y, ctx.tape = problem.linearize(_array(x), given)
        ctx.save_for_backward(x)
        return _like(y, x)

    @staticmethod
    def backward(ctx, y_bar):
        if not torch.is_grad_enabled():
            return _like(ctx.tape.pullback(_array(y_bar)), y_bar), None, None
        x, = ctx.saved_tensors
        return _Pullback.apply(y_bar, x, ctx.tape), None, None


class _Pullback(torch.autograd.Function):
    """J^T y_bar under create_graph: depends on x and y_bar, and says so."""

    @staticmethod
    def forward(ctx, y_bar, x, tape):
        return _like(tape.pullback(_array(y_bar)), y_bar)

    @staticmethod
    def backward(ctx, x_dot):
        raise NotImplementedError(
            "physinv.torch only has first derivatives, but second ones were "
            "requested; Problem.hessian has those of the loss if 'hessian' is "
            "among the problem's names")


def _checked(name, value):
    if not isinstance(value, torch.Tensor):
        raise TypeError(f"{name} is {type(value).__name__}; expected a tensor "
                        "of float32 or float64")
    if value.dtype not in _PRECISIONS:
        raise TypeError(f"{name} is {value.dtype}; expected float32 or float64")
    return value


def differentiable(problem):
    if "vjp" not in problem.names:
        raise TypeError(f"{problem.name} provides {'|'.join(problem.names)}, "
                        "no vjp, which autograd needs")

    def forward(x, given=None):
        _checked("x", x)
        if given is not None:
            if _checked("given", given).requires_grad and torch.is_grad_enabled():
                raise TypeError(
                    "given requires a gradient, but only derivatives by x "
                    "exist; pass given.detach()")
            given = _array(given.to(x.dtype))
        return _Forward.apply(x, given, problem)

    return forward
