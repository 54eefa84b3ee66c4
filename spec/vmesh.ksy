meta:
  id: vmesh
  title: .vmesh, a picture as a triangle mesh
  file-extension: vmesh
  license: MIT
  ks-version: '0.10'
  endian: le
  bit-endian: le
doc: |
  Container and header of version 1.1; `vmesh.md`, sections 3 and 4, is normative. The content of
  the chunk `M`, and most of that of `T`, is the output of a range coder (sections 5 to 8), which
  cannot be described here. Checksums, shortest forms of numbers, ranges and the order of the chunks are not
  checked, nor that a file ends where it should.
doc-ref: vmesh.md
seq:
  - id: signature
    contents: [0x8b, VM, 0x0d, 0x0a]
  - id: header
    type: header
  - id: chunks
    type: chunk
    repeat: eos
types:
  header:
    seq:
      - id: version_minor
        type: b4
      - id: version_major
        type: b4
      - id: kind
        type: b2
        doc: 0 grey, 2 RGB, 3 RGB and alpha; 1 if the next byte says it
      - id: subdivision
        type: b4
        doc: a pixel is 2**subdivision lattice units
      - id: connectivity
        type: b2
        enum: connectivity
      - id: deep
        type: deep
        if: kind == 1
      - id: width
        type: varint
      - id: height
        type: varint
      - id: n_vertices
        type: varint
      - id: steps
        type: varint
        repeat: expr
        repeat-expr: '(kind == 1 ? deep.components_less_1 : kind) + 1'
      - id: crc
        type: u4
        doc: CRC-32 of everything before it, the signature included
    enums:
      connectivity:
        0: implied
        1: listed
        2: flipped
  deep:
    seq:
      - id: components_less_1
        type: b2
        doc: 0 grey, 2 RGB, 3 RGB and alpha
      - id: depth_less_8
        type: b4
      - id: reserved
        type: b2
  chunk:
    seq:
      - id: tag
        type: str
        size: 1
        encoding: ASCII
        doc: a capital letter is critical, a small one ancillary
      - id: length
        type: varint
      - id: content
        size: length.value
        type:
          switch-on: tag
          cases:
            '"G"': grid
            '"T"': tile
      - id: crc
        type: u4
        doc: CRC-32 of tag, length and content
  grid:
    seq:
      - id: side
        type: varint
        doc: of the tiles, in pixels
  tile:
    doc: One of the tiles of the grid; they come row by row from the top, each row from the left.
    seq:
      - id: n_vertices
        type: varint
      - id: coded
        size-eos: true
  varint:
    doc: A number in groups of seven bits, the lowest first.
    seq:
      - id: groups
        type: group
        repeat: until
        repeat-until: not _.goes_on
    instances:
      value:
        value: >-
          groups[0].bits
          + (groups.size > 1 ? groups[1].bits << 7 : 0)
          + (groups.size > 2 ? groups[2].bits << 14 : 0)
          + (groups.size > 3 ? groups[3].bits << 21 : 0)
          + (groups.size > 4 ? groups[4].bits << 28 : 0)
    types:
      group:
        seq:
          - id: bits
            type: b7
          - id: goes_on
            type: b1
