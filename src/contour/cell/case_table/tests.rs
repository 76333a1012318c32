use super::*;
use std::collections::HashSet;

fn all_rows() -> impl Iterator<Item = (u8, u8, &'static Case)> {
    let table = CaseTable::get();
    (0..=255u8).flat_map(move |mask| {
        let faces = table.masks[mask as usize].1;
        (0..1u8 << faces.count_ones()).map(move |packed| {
            let bits = unpack(packed, faces);
            (mask, bits, table.case(table.id(mask, FaceChoice::from_bits(bits))))
        })
    })
}

#[test]
fn rows_are_found_by_mask_and_choice() {
    let table = CaseTable::get();
    let ids: HashSet<u16> =
        all_rows().map(|(m, bits, _)| table.id(m, FaceChoice::from_bits(bits)).0).collect();
    assert_eq!(ids.len(), table.rows.len());
    for mask in CHECKERBOARDS {
        assert_eq!(table.id(mask, FaceChoice::from_bits(0x3f)), table.id(mask, FaceChoice::INSIDE_APART));
    }
    // 656 choices in all, less 63 for each of the checkerboards.
    assert_eq!(table.rows.len(), 656 - 2 * 63);
}

#[test]
fn every_sheet_is_a_cycle() {
    for (mask, bits, case) in all_rows() {
        let crossed: EdgeSet =
            Edge::all().filter(|e| (mask & e.low().bit() != 0) != (mask & e.high().bit() != 0)).collect();
        let of_sheets: usize = case.sheets().iter().map(|s| s.edges.len()).sum();
        assert_eq!(of_sheets, crossed.len());
        for (number, sheet) in case.sheets().iter().enumerate() {
            assert!(sheet.edges.len() >= 3 && sheet.edges.iter().all(|e| crossed.contains(e)));
            // Walk along the pairs: each crossing is in two of them, and one round visits all.
            let partners = |edge: Edge| -> Vec<Edge> {
                let pairs = Face::all().flat_map(|f| case.pairs(f)).filter(|p| p.edges.contains(&edge));
                pairs.map(|p| if p.edges[0] == edge { p.edges[1] } else { p.edges[0] }).collect()
            };
            let first = sheet.edges.iter().next().unwrap();
            let (mut previous, mut at, mut steps) = (first, partners(first)[0], 1);
            while at != first {
                let both = partners(at);
                assert_eq!(both.len(), 2);
                let next = if both[0] == previous { both[1] } else { both[0] };
                assert_eq!(case.sheet_of(at) as usize, number, "{mask:#x} {bits:#x}");
                (previous, at, steps) = (at, next, steps + 1);
            }
            assert_eq!(steps, sheet.edges.len());
        }
    }
}

#[test]
fn all_but_one_of_several_sheets_are_caps() {
    let mut several = 0;
    for (mask, bits, case) in all_rows() {
        assert!(case.sheets().len() <= MAX_SHEETS);
        if !case.has_several_sheets() {
            continue;
        }
        several += 1;
        let main = case.sheets().iter().filter(|s| s.kind == SheetKind::Main).count();
        assert!(main <= 1, "{mask:#x} {bits:#x}");
        let inside = |c: Corner| mask & c.bit() != 0;
        for sheet in case.sheets() {
            match sheet.kind {
                SheetKind::Main => {}
                SheetKind::CornerCap(c) => assert_eq!(sheet.edges, c.edges()),
                SheetKind::EdgeCap(e) => {
                    assert_eq!(sheet.edges, e.adjacent());
                    assert_eq!(inside(e.low()), inside(e.high()));
                }
            }
        }
    }
    assert!(several > 100);
}

#[test]
fn ambiguous_faces_are_joined_as_chosen() {
    for (mask, bits, case) in all_rows().filter(|(mask, ..)| !CHECKERBOARDS.contains(mask)) {
        for face in Face::all().filter(|&f| case.is_ambiguous(f)) {
            let around = case.pairs(face).iter().map(|p| p.around.unwrap());
            let outside = bits & face.bit() != 0;
            assert!(around.into_iter().all(|c| (mask & c.bit() != 0) != outside));
        }
    }
}

/// Turning inside out and choosing the other way joins the same crossings.
#[test]
fn complements_have_the_same_sheets() {
    let table = CaseTable::get();
    for (mask, bits, case) in all_rows().filter(|(mask, ..)| !CHECKERBOARDS.contains(mask)) {
        let other = table.case(table.id(!mask, FaceChoice::from_bits(!bits)));
        let sets = |c: &Case| c.sheets().iter().map(|s| s.edges).collect::<Vec<_>>();
        assert_eq!(sets(case), sets(other), "{mask:#x}");
    }
}

/// Both cells of a face join it alike: the pairs depend on the signs of the face only.
#[test]
fn neighbours_agree_on_their_face() {
    use crate::lattice::Axis;
    for axis in Axis::ALL {
        let upper = Face::upper(axis);
        let lower = Face::all().find(|&f| f.axis() == axis && f != upper).unwrap();
        for signs in 0..16u8 {
            let mask = |face: Face| {
                let corners = face.corners();
                (0..4).filter(|&i| signs >> i & 1 == 1).fold(0, |m, i| m | corners[i].bit())
            };
            for choice in [0, !0].map(FaceChoice::from_bits) {
                let joined = |face: Face| {
                    let position = |e: Edge| face.edges().iter().position(|&x| x == e).unwrap();
                    let pairs = face_pairs(face, mask(face), choice);
                    pairs.iter().map(|p| p.edges.map(position)).collect::<Vec<_>>()
                };
                assert_eq!(joined(upper), joined(lower));
            }
        }
    }
}
