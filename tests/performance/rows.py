"""What is compared: a row of the table is a stage of this suite and a method of a
PyTorch program with the same problem, network, batch, precision and updates.
"""

from dataclasses import dataclass, replace

from nets import Net, fno, mlp, pooled, unet, vgg


@dataclass
class Row:
    experiment: str
    label: str
    ours: str  # experiment/method/stage
    settings: dict  # of n and iterations
    theirs: str  # program and flags
    key: str  # method of its output
    per: int = 1  # updates or examples that the times are divided by
    net: Net = None
    counted: bool = False  # operations are of interest
    sets: str = ""  # of geometric means
    profile: str = "paper"
    seeds: str = "0"  # the last counts: those before it touch the memory
    steady: bool = False  # see lengths

    @property
    def name(self):
        return f"{self.experiment}: {self.label}"

    @property
    def updates(self):
        """In what the times are of."""
        return self.settings["iterations"] // self.per if self.counted else 1

    def lengths(self):
        """Of the PyTorch program: itself, and if its first update takes longer than the
        others, with twice as many, of which the second half counts."""
        if not self.steady:
            return [self]
        count = self.settings["iterations"]
        return [self, replace(self, theirs=self.theirs.replace(f"--steps={count} ",
                                                               f"--steps={2 * count} "))]


def jpo(title, experiment, n, updates, net, descent=False, sets="27 19", seeds="0-7"):
    train = {"n": n, "iterations": updates}
    methods = "gd,jpo,supervised" if descent else "jpo,supervised"
    peer = f"jpo-{experiment} --n={n} --steps={updates} --method={methods}"

    def row(label, method, settings, key, net=None):
        return Row(title, label, f"jpo/{experiment}/{method}", settings, peer, key,
                   net=net, counted=bool(net), sets=sets, seeds="0" if net else seeds)
    return ([row("BFGS", "bfgs/solve", {"n": n}, "bfgs")] +
            [row("gradient descent", "gd/solve", {"n": n}, "gd")] * descent +
            [row("refinement", "jpo/refine", train, "jpo+refine"),
             row(f"JPO, {updates} iterations", "jpo/fit", train, "jpo", net),
             row(f"supervised, {updates} iterations", "supervised/fit", train,
                 "supervised", net)])


def updates(title, label, ours, count, theirs, key, net=None, n=None, **more):
    """Time of one of so many updates."""
    settings = {"iterations": count} | ({"n": n} if n else {})
    return Row(title, label, ours, settings, f"{theirs} --steps={count} --method={key}",
               key, count, net, True, **more)


def alignment(label, key):
    sizes = "1,2,4,8,16,32,64,128,256"
    return Row("gradient alignment, 1000 repetitions, n to 256", label,
               f"jpo/gradient-alignment/{label}/measure",
               {"n": sizes, "iterations": 1000},
               f"jpo-gradient-alignment --seeds=1000 --n={sizes} --method={key}", key,
               seeds="0-2")


def toy(label, key, net=None):
    return updates("toy, b = 256", label, f"hig/toy-gamma-0p01/{key}/train", 1600,
                   "hig-toy --seeds=1 --gamma=0.01", key, net)


def poisson(label, method, batch, count, key, net, side=64, flags="", sets="27",
            steady=True):
    return updates(f"SIP's Poisson, {side} x {side}, b = {batch}", label,
                   f"sip/poisson{method}/train", count,
                   f"sip-poisson --grid={side}x{side} --n={batch} --batch={batch}{flags}",
                   key, net, n=8, sets=sets, seeds="0-2", steady=steady)


def heat(label, key):
    return updates("heat, b = 8", label, f"sip/heat/{key}-b8/train", 20,
                   "sip-heat --n=8 --batch=8", key, unet(8, 64), n=8, seeds="0-2",
                   steady=True)


def fluid(label, key):
    return updates("SIP's fluid, b = 16", label, f"sip/fluid/{key}-b16/train", 10,
                   "sip-fluid --n=16 --test=4", key, unet(16, 64, 2, 2, 5), n=4,
                   seeds="0-2", steady=True)


ARM, BALLS = mlp(128, 2, 128, 128, 128, 4), mlp(128, 32, 128, 128, 128, 2)
KURAMOTO = vgg(32, 2, 128, [32, 32, 64, 64], 64, 64, 2)
ROWS = [
    *jpo("billiards, n = 128", "billiards", 128, 300, BALLS, descent=True),
    *jpo("robotic arm, n = 128", "robotic-arm", 128, 300, ARM, descent=True, sets=""),
    *[row for n in (32, 128)
      for row in jpo(f"wave packet, n = {n}", "wave-packet", n, 100,
                     vgg(n, 1, 256, [16] * 5, 64, 32, 1))],
    *jpo("Kuramoto-Sivashinsky, n = 32", "kuramoto-sivashinsky", 32, 20, KURAMOTO,
         seeds="0"),
    alignment("known", "a"),
    alignment("unequal", "a_equal_snr"),
    alignment("linear", "b"),
    toy("Adam", "adam", mlp(256, 1, 7, 2)),
    toy("HIG", "hig"),
    toy("Gauss-Newton", "gn"),
    updates("oscillators", "Adam, b = 512", "hig/oscillators/adam/train", 160,
            "hig-oscillators", "adam", mlp(512, 4, 20, 20, 20, 96)),
    updates("oscillators, b = 128", "HIG", "hig/oscillators/hig/train", 64,
            "hig-oscillators", "hig", sets="27 19"),
    updates("oscillators, b = 128", "Gauss-Newton", "hig/oscillators/gn/train", 16,
            "hig-oscillators", "gn", sets="27"),
    updates("Poisson", "Adam, b = 64", "hig/poisson/adam/adam", 1000,
            "hig-poisson", "adam", mlp(64, 64, 64, 256, 64, 64)),
    updates("Poisson", "HIG, b = 16", "hig/poisson/hig-002-b16/hig", 16,
            "hig-poisson --batch-hig=16", "hig", sets="27", profile="standard"),
    updates("quantum dipole", "Adam, b = 256", "hig/quantum-dipole/adam-b256-5e-4/train",
            32, "hig-quantum-dipole --n-test=16", "adam", mlp(256, 28, 20, 20, 20, 384)),
    updates("quantum dipole", "HIG, b = 16", "hig/quantum-dipole/hig/train", 64,
            "hig-quantum-dipole --n-test=16", "hig", sets="27 19"),
    *[updates("exponential, b = 100", label, f"sip/exponential/{key}/train", 2000,
              "sip-exp --n=100", key, mlp(100, 1, 16, 64, 16, 1), sets="27")
      for label, key in (("Adam", "adam"), ("Newton", "newton"))],
    *[updates("sine, b = 100", label, f"sip/sine-xi32-phi45/{key}/train", 2000,
              "sip-sine --n=1000 --sip-loss=l1", key, mlp(100, 2, 32, 64, 32, 2),
              sets="27") for label, key in (("SIP", "sip"), ("Adam", "adam"))],
    updates("SIP's wave packet, b = 100", "net", "sip/wave-packet/net/train", 200,
            "sip-wave-packet --n=8 --train-n=100", "net", pooled(100), n=8),
    poisson("SIP", "/sip", 128, 5, "sip", unet(128, 64)),
    poisson("Adam", "/adam", 128, 5, "adam", unet(128, 64)),
    poisson("SIP", "/sip-b8", 8, 20, "sip", unet(8, 64), sets=""),
    poisson("Adam", "/adam-b8", 8, 20, "adam", unet(8, 64), sets=""),
    poisson("FNO", "-fno/fno", 128, 1, "fno", fno(128), sets="", steady=False),
    poisson("Hessian-free, 40 products", "-32/hf-40-b8", 8, 2, "hf", None, 32,
            " --max-cg=40", sets="", steady=False),
    poisson("AdaHessian", "-32/adahessian-b8", 8, 20, "adahessian", None, 32, sets=""),
    heat("SIP", "sip"),
    heat("Adam", "adam"),
    Row("heat, single examples", "inverse, 100 steps, 128 of them",
        "sip/heat/inverse-physics/solve", {"n": 128, "iterations": 100},
        "sip-heat --method=invphys --n-direct=128 --steps=100", "invphys", seeds="0-2"),
    Row("heat, single examples", "L-BFGS, 1000 steps, each", "sip/heat/lbfgsb/solve",
        {"n": 8, "iterations": 1000},
        "sip-heat --method=lbfgs --n-direct=8 --steps=1000", "lbfgs", 8, seeds="0-2"),
    fluid("SIP", "sip"),
    fluid("Adam", "adam"),
    Row("JPO's fluid, n = 16", "BFGS", "jpo/navier-stokes/bfgs/solve", {"n": 16},
        "jpo-navier-stokes --n=16 --method=bfgs --no-refine --dtype=float64", "bfgs"),
]

# Of which the table's geometric means are.
SETS = {"all rows": lambda row: True,
        "the 27": lambda row: "27" in row.sets,
        "the 19": lambda row: "19" in row.sets}
