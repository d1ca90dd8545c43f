# Every claims.md of an experiment, by its folder, each with a zero at its end;
# an empty name ends the list. Editing one compiles nothing.
    .section .note.GNU-stack, "", %progbits
    .section .rodata

    .macro claims folder
    .asciz "\folder"
    .incbin "\folder/claims.md"
    .byte 0
    .endm

    .global physinv_claim_texts
physinv_claim_texts:
    claims hig/oscillators
    claims hig/overview
    claims hig/poisson
    claims hig/quantum_dipole
    claims hig/toy
    claims jpo/adjoint_wall
    claims jpo/bfgs_precision
    claims jpo/billiards
    claims jpo/flow_bounds
    claims jpo/gradient_alignment
    claims jpo/kuramoto_sivashinsky
    claims jpo/navier_stokes
    claims jpo/overview
    claims jpo/packet_unit
    claims jpo/robotic_arm
    claims jpo/wave_packet
    claims numerics/common
    claims numerics/half_inverse
    claims numerics/kuramoto_sivashinsky
    claims numerics/transport
    claims physgrad/scaling
    claims sip/exponential
    claims sip/fluid
    claims sip/heat
    claims sip/overview
    claims sip/packet_width
    claims sip/poisson
    claims sip/sine
    claims sip/wave_packet
    .byte 0
