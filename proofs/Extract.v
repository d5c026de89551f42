(* Laws that are not passive: energy is drawn without limit, so that no storage function exists. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion Power Terms Continuous Relaxation Passive.
Open Scope R_scope.

(* --- held at v, z obeys a linear equation with a closed solution ---------------------------------------------------------- *)

Lemma exp_above x : 1 + x <= exp x.
Proof. apply exp_ineq1_le. Qed.

Definition unwinding (mu la z0 t : R) : R :=
  if Req_EM_T la 0 then z0 + mu * t else mu / la + (z0 - mu / la) * exp (- (la * t)).

Lemma unwinding_derive mu la z0 t : is_derive (unwinding mu la z0) t (mu - la * unwinding mu la z0 t).
Proof.
  unfold unwinding. destruct (Req_EM_T la 0) as [-> | N]; auto_derive; auto; try ring. field. exact N.
Qed.

Lemma unwinding_0 mu la z0 : unwinding mu la z0 0 = z0.
Proof. unfold unwinding. destruct (Req_EM_T la 0); [ring|]. rewrite Rmult_0_r, Ropp_0, exp_0. ring. Qed.

(* While mu - la z0 <= 0, z falls, and no faster than at first. *)
Lemma unwinding_range mu la z0 t : 0 <= la -> mu - la * z0 <= 0 -> 0 <= t ->
  z0 + (mu - la * z0) * t <= unwinding mu la z0 t <= z0.
Proof.
  intros Hl H0 Ht. unfold unwinding. destruct (Req_EM_T la 0) as [-> | N]; [nra|].
  assert (L : 0 < la) by lra. assert (A : 0 <= z0 - mu / la).
  { apply Rmult_le_reg_l with la; [exact L|]. replace (la * (z0 - mu / la)) with (la * z0 - mu) by (field; lra). lra. }
  pose proof (exp_above (- (la * t))) as E. pose proof (exp_neg_range (la * t)) as B.
  assert (0 <= la * t) by (apply Rmult_le_pos; lra). specialize (B H). set (b := exp (- (la * t))) in *.
  replace (mu - la * z0) with (- (la * (z0 - mu / la))) by (field; lra). set (d := z0 - mu / la) in *.
  replace z0 with (mu / la + d) by (unfold d; ring). nra.
Qed.

(* For every E some held v takes z down from z0, by at most K in a second, while a power P or more is drawn,
   and P T >= E for the time T = (z0 - z1)/K in which z stays above z1. *)
Definition drained (dz F : R -> R -> R) (z1 z0 : R) : Prop :=
  forall E, exists v mu la K P, 0 <= la /\ 0 < K /\ mu - la * z0 <= 0 /\ - K <= mu - la * z0 /\
    (forall z, z1 <= z <= z0 -> dz v z = mu - la * z) /\ (forall z, z1 <= z <= z0 -> F v z * v <= - P) /\
    E <= P * ((z0 - z1) / K).

(* Then no storage function exists; held inputs may hold more than the velocity. *)
Theorem no_storage {U : UniformSpace} (f pw : U -> R -> R) (ok : U -> Prop) (input : R -> U) (dz F : R -> R -> R)
  (dom : R -> Prop) (z1 z0 : R) : z1 < z0 -> (forall z, z1 <= z <= z0 -> dom z) ->
  (forall v, ok (input v)) -> (forall v z, f (input v) z = dz v z) -> (forall v z, pw (input v) z = F v z * v) ->
  drained dz F z1 z0 -> ~ exists S, storage f ok pw dom S.
Proof.
  intros Hz Hdom Hok Ef Ep H [S [S0 Hs]].
  destruct (H (S z0 + 1)) as (v & mu & la & K & P & Hl & HK & Hf & HfK & Hrate & Hpower & HE).
  set (T := (z0 - z1) / K) in *. assert (HT : 0 < T) by (apply Rdiv_lt_0_compat; lra).
  assert (KT : K * T = z0 - z1) by (unfold T; field; lra).
  set (z := unwinding mu la z0).
  assert (R : forall t, 0 <= t <= T -> z1 <= z t <= z0).
  { intros t Ht. unfold z. pose proof (unwinding_range mu la z0 t Hl Hf (proj1 Ht)).
    assert (K * t <= K * T) by (apply Rmult_le_compat_l; lra).
    assert (- K * t <= (mu - la * z0) * t) by (apply Rmult_le_compat_r; lra). lra. }
  assert (M : motion f (fun _ => input v) z 0 T).
  { apply motion_of_piece. split; [exact HT|]. exists (fun _ => input v), z.
    split; [intros t; apply continuous_const|]. split.
    { intros t. apply (is_derive_continuous z t (mu - la * z t)). apply unwinding_derive. }
    split; [reflexivity|]. intros t Ht. split; [reflexivity|].
    rewrite Ef, Hrate by (apply R; lra). apply unwinding_derive. }
  assert (Z0 : z 0 = z0) by apply unwinding_0.
  destruct (Hs (fun _ => input v) z 0 T M) as [X I]; [intros; apply Hok|rewrite Z0; apply Hdom; lra|].
  assert (B : RInt (fun t => pw (input v) (z t)) 0 T <= RInt (fun _ => - P) 0 T).
  { apply RInt_le; [lra|exact X|apply ex_RInt_const|]. intros t Ht. rewrite Ep. apply Hpower, R. lra. }
  rewrite RInt_const in B. change (scal (T - 0) (- P)) with ((T - 0) * - P) in B.
  assert (0 <= S (z T)) by (apply S0, Hdom, R; lra). rewrite Z0 in I. lra.
Qed.

Theorem not_passive (dz F : R -> R -> R) (dom : R -> Prop) (z1 z0 : R) : z1 < z0 ->
  (forall z, z1 <= z <= z0 -> dom z) -> drained dz F z1 z0 -> ~ passive dz F dom.
Proof.
  intros Hz Hdom H. apply (no_storage (U := R_UniformSpace) dz (power_of F) any (fun v => v) dz F dom z1 z0); auto.
  intros v. exact I.
Qed.

(* --- lugre_sobczyk, whatever its constants -------------------------------------------------------------------------------- *)

(* At v = -e/k_v: S_0(v) = -S with 0 < S <= e. *)
Lemma S_0_small p e : 0 < k_v p -> 0 < e <= 1 -> exists Se, S_0 p (- (e / k_v p)) = - Se /\ 0 < Se <= e.
Proof.
  intros Hk He. exists (2 / PI * atan e). pose proof PI_RGT_0 as Hp. pose proof PI2_1 as P2. split.
  - unfold S_0. replace (k_v p * - (e / k_v p)) with (- e) by (field; lra). rewrite atan_opp. ring.
  - assert (A : 0 < atan e) by (rewrite <- atan_0; apply atan_increasing; lra).
    assert (C : 0 < 2 / PI <= 1).
    { split; [apply Rdiv_lt_0_compat; lra|]. apply Rmult_le_reg_r with PI; [lra|].
      unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra. }
    pose proof (atan_le e). split; [apply Rmult_lt_0_compat; lra|]. nra.
Qed.

(* What both proofs need: a rate -(e/k_v) S (S + share z/g) with a share that is 1, or 0, on the way from z0 to z0/2. *)
Section Slow.
Variables (p : constants) (dz F : R -> R -> R) (damping : R -> R) (D share z0 : R).
Hypothesis Hs0 : 0 < sigma_0 p.
Hypothesis Hs2 : 0 <= sigma_2 p.
Hypothesis HFc : 0 < F_c p <= F_s p.
Hypothesis Hk : 0 < k_v p.
Hypothesis Hdamping : forall v, 0 <= damping v <= D.
Hypothesis Hshare : 0 <= share <= 1.
Hypothesis Hz0 : 0 < z0.
Hypothesis Hrate : forall v z, z0 / 2 <= z <= z0 -> dz v z = S_0 p v * S_0 p v * v - share * (v * S_0 p v) / g p v * z.
Hypothesis Hforce : forall v z, F v z = sigma_0 p * z + damping v * dz v z + sigma_2 p * v.

Lemma slow_unwinding : drained dz F (z0 / 2) z0.
Proof.
  intros E.
  set (G := F_c p / sigma_0 p). assert (HG : 0 < G) by (apply Rdiv_lt_0_compat; lra).
  set (C := 1 + z0 / G). assert (HC : 1 < C) by (unfold C; assert (0 < z0 / G) by (apply Rdiv_lt_0_compat; lra); lra).
  (* the power drawn is (e/k) F >= (e/k) c; it lasts (z0/2)/((e/k) S C); so E <= c z0/(2 e C) is wanted *)
  set (c := sigma_0 p * z0 / 4). assert (Hc : 0 < c) by (unfold c; assert (0 < sigma_0 p * z0) by nra; lra).
  set (B := Rabs E + 1). assert (HB : 0 < B) by (unfold B; pose proof (Rabs_pos E); lra).
  pose proof (Hdamping 0) as HD. assert (HDC : 0 <= D * C) by (apply Rmult_le_pos; lra).
  set (e1 := c * k_v p / (D * C + sigma_2 p + 1)). set (e2 := c * z0 / (2 * C * B)).
  assert (H1 : 0 < e1) by (apply Rdiv_lt_0_compat; nra).
  assert (H2 : 0 < e2) by (apply Rdiv_lt_0_compat; [nra|]; apply Rmult_lt_0_compat; lra).
  set (e := Rmin 1 (Rmin e1 e2)).
  assert (He : 0 < e <= 1 /\ e <= e1 /\ e <= e2).
  { unfold e. pose proof (Rmin_l 1 (Rmin e1 e2)). pose proof (Rmin_r 1 (Rmin e1 e2)).
    pose proof (Rmin_l e1 e2). pose proof (Rmin_r e1 e2). repeat split; try lra. repeat apply Rmin_glb_lt; lra. }
  destruct He as (He & He1 & He2). destruct (S_0_small p e Hk He) as (Se & ES & HSe).
  set (v := - (e / k_v p)). set (V := e / k_v p). assert (HV : 0 < V) by (apply Rdiv_lt_0_compat; lra).
  assert (Hg : G <= g p v) by (apply g_range; lra). set (gv := g p v) in *.
  assert (Hr : forall z, z0 / 2 <= z <= z0 -> dz v z = - (Se * Se * V) - share * (V * Se) / gv * z).
  { intros z Hz. rewrite (Hrate v z Hz). fold v in ES. rewrite ES. fold gv. unfold v. fold V. field. lra. }
  assert (Hgi : 0 < / gv <= / G) by (split; [apply Rinv_0_lt_compat; lra|apply Rinv_le_contravar; lra]).
  assert (VS : 0 < V * Se) by (apply Rmult_lt_0_compat; lra).
  assert (Sh : 0 <= share * z0 * / gv <= z0 / G).
  { split; [repeat apply Rmult_le_pos; lra|]. unfold Rdiv.
    apply Rmult_le_compat; try lra; [apply Rmult_le_pos; lra|].
    replace z0 with (1 * z0) at 2 by ring. apply Rmult_le_compat_r; lra. }
  exists v, (- (Se * Se * V)), (share * (V * Se) / gv), (V * Se * C), (V * c).
  assert (Q : share * (V * Se) / gv * z0 = V * Se * (share * z0 * / gv)) by (field; lra).
  split; [apply Rmult_le_pos; [apply Rmult_le_pos|]; lra|]. split; [apply Rmult_lt_0_compat; lra|].
  split; [rewrite Q; nra|]. split.
  { rewrite Q. replace (- (Se * Se * V)) with (- (V * Se * Se)) by ring. unfold C.
    assert (V * Se * Se <= V * Se * 1) by (apply Rmult_le_compat_l; lra).
    assert (V * Se * (share * z0 * / gv) <= V * Se * (z0 / G)) by (apply Rmult_le_compat_l; lra). lra. }
  split; [exact Hr|]. split.
  - intros z Hz. rewrite Hforce, (Hr z Hz).
    set (f := - (Se * Se * V) - share * (V * Se) / gv * z).
    assert (Hf : - f <= V * Se * C).
    { unfold f. replace (share * (V * Se) / gv * z) with (V * Se * (share * / gv * z)) by (field; lra).
      assert (share * / gv * z <= z0 / G).
      { apply Rle_trans with (share * / gv * z0); [apply Rmult_le_compat_l; [apply Rmult_le_pos|]; lra|]. lra. }
      assert (V * Se * (share * / gv * z) <= V * Se * (z0 / G)) by (apply Rmult_le_compat_l; lra).
      assert (V * Se * Se <= V * Se * 1) by (apply Rmult_le_compat_l; lra). unfold C. lra. }
    assert (E1 : V * (D * C + sigma_2 p) <= c).
    { assert (e * (D * C + sigma_2 p + 1) <= c * k_v p).
      { apply Rmult_le_compat_r with (r := D * C + sigma_2 p + 1) in He1; [|lra].
        unfold e1 in He1. unfold Rdiv in He1. rewrite Rmult_assoc, Rinv_l in He1; lra. }
      unfold V. apply Rmult_le_reg_r with (k_v p); [exact Hk|].
      replace (e / k_v p * (D * C + sigma_2 p) * k_v p) with (e * (D * C + sigma_2 p)) by (field; lra). nra. }
    assert (E2 : damping v * - f <= V * (D * C)).
    { pose proof (Hdamping v) as Dv. apply Rle_trans with (damping v * (V * Se * C)); [apply Rmult_le_compat_l; lra|].
      replace (damping v * (V * Se * C)) with (V * (damping v * (Se * C))) by ring.
      apply Rmult_le_compat_l; [lra|]. apply Rmult_le_compat; try lra; [apply Rmult_le_pos; lra|].
      replace C with (1 * C) at 2 by ring. apply Rmult_le_compat_r; lra. }
    assert (E3 : sigma_0 p * (z0 / 2) <= sigma_0 p * z) by (apply Rmult_le_compat_l; lra).
    replace v with (- V) by reflexivity.
    assert (c <= sigma_0 p * z + damping v * f + sigma_2 p * - V) by (unfold c in *; lra).
    replace (- V) with v in H |- * by reflexivity.
    assert (V * c <= V * (sigma_0 p * z + damping v * f + sigma_2 p * v)) by (apply Rmult_le_compat_l; lra).
    replace ((sigma_0 p * z + damping v * f + sigma_2 p * v) * v)
      with (- (V * (sigma_0 p * z + damping v * f + sigma_2 p * v))) by (unfold v, V; ring). lra.
  - replace (V * c * ((z0 - z0 / 2) / (V * Se * C))) with (c * z0 / (2 * C * Se)) by (field; lra).
    assert (B <= c * z0 / (2 * C * Se)); [|unfold B in *; pose proof (Rle_abs E); lra].
    assert (K : 0 < 2 * C * Se) by (repeat apply Rmult_lt_0_compat; lra).
    apply Rmult_le_reg_r with (2 * C * Se); [exact K|]. unfold Rdiv. rewrite (Rmult_assoc (c * z0)), Rinv_l by lra.
    assert (L : Se * (2 * C * B) <= e2 * (2 * C * B)).
    { apply Rmult_le_compat_r; [|lra]. apply Rlt_le. repeat apply Rmult_lt_0_compat; lra. }
    unfold e2, Rdiv in L. rewrite (Rmult_assoc (c * z0)), Rinv_l in L; [lra|].
    apply Rgt_not_eq. repeat apply Rmult_lt_0_compat; lra.
Qed.
End Slow.

Lemma z_bound_pos p : 0 < sigma_0 p -> 0 < F_s p -> 0 < F_s p / sigma_0 p.
Proof. intros. apply Rdiv_lt_0_compat; assumption. Qed.

Lemma within_upper (z0 Z : R) : 0 < z0 <= Z -> forall z, z0 / 2 <= z <= z0 -> within Z z.
Proof. intros H z Hz. unfold within. rewrite Rabs_pos_eq; lra. Qed.

Theorem lugre_sobczyk_not_passive p : lugre_sobczyk.allowed p ->
  ~ passive (lugre_sobczyk.dz_dt p) (lugre_sobczyk.friction p) (within (lugre_sobczyk.z_bound p)).
Proof.
  intros (H0 & H1 & H2 & Hc & Hs & Hv & Hk & HF). pose proof (z_bound_pos p H0 Hs) as HZ.
  apply (not_passive _ _ _ (F_s p / sigma_0 p / 2) (F_s p / sigma_0 p)); [lra|apply within_upper; unfold lugre_sobczyk.z_bound; lra|].
  apply (slow_unwinding p _ _ (fun _ => sigma_1 p) (sigma_1 p) 1); auto; try lra.
  - intros _. lra.
  - intros v z _. unfold lugre_sobczyk.dz_dt. rewrite Rmult_1_l. reflexivity.
Qed.

Theorem lugre_sobczyk_not_passive_v_d p : lugre_sobczyk.allowed_v_d p ->
  ~ passive (lugre_sobczyk.dz_dt p) (lugre_sobczyk.friction_v_d p) (within (lugre_sobczyk.z_bound p)).
Proof.
  intros (H0 & H1 & H2 & Hc & Hs & Hv & Hk & Hd & HF). pose proof (z_bound_pos p H0 Hs) as HZ.
  apply (not_passive _ _ _ (F_s p / sigma_0 p / 2) (F_s p / sigma_0 p)); [lra|apply within_upper; unfold lugre_sobczyk.z_bound; lra|].
  apply (slow_unwinding p _ _ (sigma_1_at p) (sigma_1 p) 1); auto; try lra.
  - intros v. apply sigma_1_at_range. exact H1.
  - intros v z _. unfold lugre_sobczyk.dz_dt. rewrite Rmult_1_l. reflexivity.
Qed.

(* Inside z_ba nothing unwinds but by S_0^2 v. *)
Theorem elastoplastic_sobczyk_not_passive p : elastoplastic_sobczyk.allowed p ->
  ~ passive (elastoplastic_sobczyk.dz_dt p) (elastoplastic_sobczyk.friction p) (within (elastoplastic_sobczyk.z_bound p)).
Proof.
  intros (H0 & H1 & H2 & Hc & Hs & Hv & Hb & Hk & HF & Hba).
  assert (B : z_ba p <= F_s p / sigma_0 p).
  { apply Rmult_le_reg_r with (sigma_0 p); [exact H0|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra. }
  apply (not_passive _ _ _ (z_ba p / 2) (z_ba p)); [lra|apply within_upper; unfold elastoplastic_sobczyk.z_bound; lra|].
  apply (slow_unwinding p _ _ (fun _ => sigma_1 p) (sigma_1 p) 0); auto; try lra.
  - intros _. lra.
  - intros v z Hz. unfold elastoplastic_sobczyk.dz_dt, alpha_0.
    destruct (Rle_dec (Rabs z) (z_ba p)) as [L | L]; [unfold Rdiv; ring|]. rewrite Rabs_pos_eq in L; lra.
Qed.

(* --- fast pulses: LuGre's condition is necessary ------------------------------------------------------------------------------ *)

Lemma g_settles p eps : 0 < sigma_0 p -> 0 < v_s p -> F_c p <= F_s p -> 0 < eps ->
  exists V, 0 <= V /\ forall v, V <= v -> sigma_0 p * g p v <= F_c p + eps.
Proof.
  intros H0 Hv HF He. set (r := (F_s p - F_c p) / eps). exists (v_s p * (1 + r)).
  assert (Hr : 0 <= r) by (apply Rmult_le_pos; [lra|apply Rlt_le, Rinv_0_lt_compat; exact He]).
  split; [apply Rmult_le_pos; lra|]. intros v HV. unfold g.
  set (x := v / v_s p). assert (X : 1 + r <= x).
  { apply Rmult_le_reg_r with (v_s p); [exact Hv|]. unfold x, Rdiv. rewrite (Rmult_assoc v), Rinv_l; lra. }
  replace (sigma_0 p * ((F_c p + (F_s p - F_c p) * exp (- (x * x))) / sigma_0 p))
    with (F_c p + (F_s p - F_c p) * exp (- (x * x))) by (field; lra).
  enough ((F_s p - F_c p) * exp (- (x * x)) <= eps) by lra.
  rewrite exp_Ropp. pose proof (exp_above (x * x)) as E.
  assert (r <= exp (x * x)) by nra. pose proof (exp_pos (x * x)) as E0.
  apply Rmult_le_reg_r with (exp (x * x)); [exact E0|]. rewrite Rmult_assoc, Rinv_l by lra.
  replace (F_s p - F_c p) with (eps * r) by (unfold r; field; lra). nra.
Qed.

Section Fast.
Variables (p : constants) (dz F : R -> R -> R) (M : R -> R) (m0 z1 z0 : R).
Hypothesis Hs0 : 0 < sigma_0 p.
Hypothesis Hs1 : 0 <= sigma_1 p.
Hypothesis Hs2 : 0 <= sigma_2 p.
Hypothesis HFc : 0 < F_c p <= F_s p.
Hypothesis Hvs : 0 < v_s p.
Hypothesis HM : forall v, 0 < v -> v <= M v <= v + m0.
Hypothesis Hz : 0 < z1 < z0.
Hypothesis Hrate : forall v z, 0 < v -> 0 < z -> g p v <= z -> dz v z = v - M v / g p v * z.
Hypothesis Hforce : forall v z, F v z = sigma_0 p * z + sigma_1 p * dz v z + sigma_2 p * v.
Hypothesis Hwound : sigma_2 p * F_c p < sigma_1 p * (sigma_0 p * z1 - F_c p).

Lemma fast_pulse : drained dz F z1 z0.
Proof.
  intros E. set (s := sigma_1 p + sigma_2 p). set (de := sigma_1 p * (sigma_0 p * z1) - s * F_c p).
  assert (Hd : 0 < de) by (unfold de, s; nra).
  assert (Hs : 0 < sigma_1 p) by (destruct Hs1 as [L | L]; [exact L|rewrite <- L in Hwound; nra]).
  assert (Ss : 0 < s) by (unfold s; lra).
  set (eps := de / (2 * s)). assert (He : 0 < eps) by (apply Rdiv_lt_0_compat; lra).
  assert (Hes : s * (F_c p + eps) + de / 2 = sigma_1 p * (sigma_0 p * z1)) by (unfold eps, de; field; lra).
  destruct (g_settles p eps Hs0 Hvs (proj2 HFc) He) as (V1 & HV1 & Hg).
  set (c := de / (2 * (F_c p + eps))). assert (Hc : 0 < c) by (apply Rdiv_lt_0_compat; lra).
  set (G := F_c p / sigma_0 p). assert (HG : 0 < G) by (apply Rdiv_lt_0_compat; lra).
  set (V2 := 2 * (sigma_0 p * z0) / c). assert (HV2 : 0 < V2).
  { apply Rdiv_lt_0_compat; [|exact Hc]. apply Rmult_lt_0_compat; [lra|]. apply Rmult_lt_0_compat; lra. }
  set (r := c * (z0 - z1) * G / (4 * z0)). assert (Hr : 0 < r).
  { apply Rdiv_lt_0_compat; [|lra]. apply Rmult_lt_0_compat; [apply Rmult_lt_0_compat|]; lra. }
  set (V3 := Rabs E / r). assert (HV3 : 0 <= V3).
  { apply Rmult_le_pos; [apply Rabs_pos|apply Rlt_le, Rinv_0_lt_compat; exact Hr]. }
  set (v := V1 + V2 + V3 + Rabs m0 + 1). pose proof (Rabs_pos m0) as Am. pose proof (Rle_abs m0) as Bm.
  assert (Hv : 0 < v /\ V1 <= v /\ V2 <= v /\ V3 <= v /\ m0 <= v) by (unfold v; repeat split; lra).
  destruct Hv as (Hv & L1 & L2 & L3 & Lm). pose proof (HM v Hv) as Mv.
  assert (Gv : G <= g p v) by (apply g_range; lra). specialize (Hg v L1). set (gv := g p v) in *.
  assert (Gz : sigma_0 p * gv <= sigma_0 p * z1).
  { apply Rle_trans with (1 := Hg). apply Rmult_le_reg_l with s; [exact Ss|].
    assert (sigma_1 p * (sigma_0 p * z1) <= s * (sigma_0 p * z1)) by (apply Rmult_le_compat_r; unfold s; nra). lra. }
  assert (gz : gv <= z1) by nra. assert (Hgv : 0 < gv) by lra.
  assert (Rt : forall z, z1 <= z <= z0 -> dz v z = v - M v / gv * z) by (intros z Hzz; apply Hrate; fold gv; lra).
  exists v, v, (M v / gv), (2 * v * z0 / G), (c * v * v / 2).
  assert (Q : M v / gv * z0 = M v * (z0 / gv)) by (field; lra).
  assert (Z1 : 1 <= z0 / gv).
  { apply Rmult_le_reg_r with gv; [exact Hgv|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra. }
  assert (Z2 : z0 / gv <= z0 / G) by (apply Rmult_le_compat_l; [lra|apply Rinv_le_contravar; lra]).
  split; [apply Rlt_le, Rdiv_lt_0_compat; lra|].
  split; [apply Rdiv_lt_0_compat; [|exact HG]; apply Rmult_lt_0_compat; lra|].
  split; [rewrite Q; nra|]. split.
  { rewrite Q. assert (M v * (z0 / gv) <= (v + m0) * (z0 / G)) by (apply Rmult_le_compat; lra).
    assert ((v + m0) * (z0 / G) <= 2 * v * (z0 / G)) by (apply Rmult_le_compat_r; lra).
    replace (2 * v * z0 / G) with (2 * v * (z0 / G)) by (field; lra). lra. }
  split; [exact Rt|]. split.
  - intros z Hzz. rewrite Hforce, (Rt z Hzz).
    (* sigma_1 z1/g >= sigma_1 + sigma_2 + c *)
    assert (A : (s + c) * gv <= sigma_1 p * z1).
    { apply Rmult_le_reg_r with (sigma_0 p); [exact Hs0|].
      assert ((s + c) * (sigma_0 p * gv) <= (s + c) * (F_c p + eps)) by (apply Rmult_le_compat_l; lra).
      assert (c * (F_c p + eps) = de / 2) by (unfold c; field; lra). nra. }
    assert (A' : s + c <= sigma_1 p * z1 / gv).
    { apply Rmult_le_reg_r with gv; [exact Hgv|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra. }
    assert (B : v * (s + c) <= sigma_1 p * (M v / gv * z)).
    { apply Rle_trans with (v * (sigma_1 p * z1 / gv)); [apply Rmult_le_compat_l; lra|].
      replace (v * (sigma_1 p * z1 / gv)) with (sigma_1 p * / gv * (v * z1)) by (field; lra).
      replace (sigma_1 p * (M v / gv * z)) with (sigma_1 p * / gv * (M v * z)) by (field; lra).
      apply Rmult_le_compat_l; [apply Rmult_le_pos; [lra|apply Rlt_le, Rinv_0_lt_compat; exact Hgv]|].
      apply Rmult_le_compat; lra. }
    assert (C : sigma_0 p * z <= c * v / 2).
    { apply Rle_trans with (sigma_0 p * z0); [apply Rmult_le_compat_l; lra|].
      apply Rmult_le_compat_r with (r := c) in L2; [|lra]. unfold V2 in L2.
      replace (2 * (sigma_0 p * z0) / c * c) with (2 * (sigma_0 p * z0)) in L2 by (field; lra). lra. }
    assert (W : sigma_0 p * z + sigma_1 p * (v - M v / gv * z) + sigma_2 p * v <= - (c * v / 2)).
    { replace (sigma_0 p * z + sigma_1 p * (v - M v / gv * z) + sigma_2 p * v)
        with (sigma_0 p * z + v * s - sigma_1 p * (M v / gv * z)) by (unfold s; ring). lra. }
    apply Rmult_le_compat_r with (r := v) in W; lra.
  - replace (c * v * v / 2 * ((z0 - z1) / (2 * v * z0 / G))) with (v * r) by (unfold r; field; lra).
    apply Rle_trans with (Rabs E); [apply Rle_abs|].
    replace (Rabs E) with (V3 * r) by (unfold V3; field; lra). apply Rmult_le_compat_r; lra.
Qed.
End Fast.
