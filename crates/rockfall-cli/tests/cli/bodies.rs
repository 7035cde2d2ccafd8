//! Rigid bodies on the command line.

use super::common::Rockfall;

/// Two bodies that nothing acts on.
const SCENE: &str = "set gravity 0\n@body ball mass=5\nS 0 0 0 0 0 0 0 0 0 0 - 1\n@end\n@place ball at=1,2,3 name=first\n\
                     @place ball at=5,0,0 orientation=0.6,0,0.8,0 velocity=0,-1,0 momentum=0,2,0\n";
const HEADER: &str = "body,name,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz\n";

#[test]
fn bodies_of_the_final_state_and_of_every_state_are_written() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --steps 0 --bodies a.csv", 0);
    let lines = ["0,first,1,2,3,0,0,0,1,0,0,0,0,0,0\n", "1,,5,0,0,0,-1,0,0.6,0,0.8,0,0,2,0\n"];
    assert_eq!(rockfall.read("a.csv"), format!("{HEADER}{}{}", lines[0], lines[1]));
    rockfall.run("run scene.txt --backend cpu --dt 0.25 --steps 4 --every 2 --bodies b.csv --checkpoint a.ckpt", 0);
    let every = rockfall.read("b.csv");
    assert!(
        every.starts_with(&format!("step,time,{HEADER}0,0,{}0,0,{}2,0.5,{}2,0.5,1,,5,", lines[0], lines[1], lines[0])),
        "{every}"
    );
    assert_eq!(every.lines().count(), 7, "{every}");

    // A resumed run goes on in the same file.
    rockfall.run("run --resume a.ckpt --steps 6", 0);
    let longer = rockfall.read("b.csv");
    assert!(longer.starts_with(&every) && longer.lines().count() == every.lines().count() + 2, "{longer}");
}

#[test]
fn bodies_are_counted() {
    let rockfall = Rockfall::with(SCENE);
    let (out, _) = rockfall.run("check scene.txt", 0);
    assert!(out.contains("2 spheres, 2 rigid bodies"), "{out}");
    let (_, err) =
        Rockfall::with("S 1 0 1 0 0 0 0 0 0 0 1 0.1\n").run("run scene.txt --backend cpu --steps 1 --bodies a.csv", 0);
    assert!(err.contains("note: --bodies: the scene has no rigid bodies and no motions"), "{err}");
}

#[test]
fn hulls_are_counted_and_other_laws_refuse_them() {
    let body = "@body t mass=1\n@hull 0,0,0 1,0,0 0,1,0 0,0,1\n@end\n@place t at=0,1,0\n@place t at=3,1,0\n";
    let (out, _) = Rockfall::with(&format!("set contact_law rigid\n{body}")).run("check scene.txt", 0);
    assert!(out.contains("2 spheres, 2 rigid bodies, 2 hulls"), "{out}");
    let (_, err) = Rockfall::with(&format!("set contact_law thesis\n{body}")).run("run scene.txt --backend cpu", 2);
    assert!(err.contains("hulls need `set contact_law rigid`"), "{err}");
}

/// A plate that turns about an axis through 1,0,0 and one that oscillates follow the bodies.
#[test]
fn moving_walls_are_bodies_too() {
    let walls = "@motion plate spin=0.5 axis=0,0,2 through=1,0,0\n@motion shaken amplitude=0,0.25,0 frequency=0.25\n\
                 @move plate\nB 0 0 0 1 0 0 0 1 0 0 0 1\n@move shaken\nB 8 0 0 1 0 0 0 1 0 0 0 1\n";
    let rockfall = Rockfall::with(&format!("{SCENE}{walls}"));
    rockfall.run("run scene.txt --backend cpu --dt 0.25 --steps 4 --every 4 --bodies a.csv", 0);
    let text = rockfall.read("a.csv");
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.iter().map(|row| row[2]).collect::<Vec<_>>(), ["0", "1", "2", "3", "0", "1", "2", "3"]);
    assert_eq!([rows[6][3], rows[7][3]], ["plate", "shaken"]);
    let numbers = |row: usize| -> Vec<f64> { rows[row][4..].iter().map(|number| number.parse().unwrap()).collect() };
    let close = |row: usize, expected: [f64; 13]| {
        let found = numbers(row);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6) && found.len() == 13, "{found:?}");
    };
    // At the start nothing has moved. After 1 s the plate has turned by 0.5 rad, and the other one is at the end of its way.
    close(2, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5]);
    close(3, [0.0, 0.0, 0.0, 0.0, std::f64::consts::TAU / 16.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    close(6, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.25_f64.cos(), 0.0, 0.0, 0.25_f64.sin(), 0.0, 0.0, 0.5]);
    close(7, [0.0, 0.25, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let alone = Rockfall::with(&format!("set gravity 0\n{walls}S 1 9 9 9 0 0 0 0 0 0 1 0.1\n"));
    let (_, err) = alone.run("run scene.txt --backend cpu --steps 1 --bodies b.csv", 0);
    assert!(!err.contains("--bodies") && alone.read("b.csv").lines().count() == 3, "{err}");
}
